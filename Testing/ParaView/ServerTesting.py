# SPDX-License-Identifier: BSD-3-Clause
"""Starts a pvserver for a test. Imports no module of ParaView, because a process that has loaded MPI cannot start
mpiexec."""

import socket
import subprocess
import time


def free_port():
    with socket.socket() as listener:
        listener.bind(("localhost", 0))
        return listener.getsockname()[1]


class Server:
    """A context manager, within whose block a server runs."""

    def __init__(self, command, log, environment=None):
        self.port = free_port()
        self.command = command + [f"--server-port={self.port}"]
        self.log_file = log
        self.environment = environment

    def __enter__(self):
        with open(self.log_file, "w", encoding="utf-8") as log:
            self.process = subprocess.Popen(
                self.command, stdout=log, stderr=subprocess.STDOUT, env=self.environment
            )
        end = time.monotonic() + 60.0
        while "Accepting connection" not in self.log():
            alive = self.process.poll() is None and time.monotonic() < end
            if not alive:
                self.__exit__()
                raise AssertionError(f"No server: {self.log()}")
            time.sleep(0.1)
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait()

    def log(self):
        with open(self.log_file, encoding="utf-8", errors="replace") as log:
            return log.read()

    def wait(self):
        """Waits until the server ends, which it does after its client."""
        self.process.wait(timeout=60)
        if self.process.returncode != 0:
            raise AssertionError(f"The server ends with {self.process.returncode}: {self.log()}")
