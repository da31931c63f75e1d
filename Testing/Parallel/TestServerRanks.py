# SPDX-License-Identifier: BSD-3-Clause
"""Tests a client with a pvserver of three ranks: voxels are those of one process, information properties are those of
all ranks, the mesh may be on one rank only, and an error is one message.

Arguments: mpiexec, pvserver, pvpython, the folder for output.
"""
import glob
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "ParaView"))
from ServerTesting import Server  # noqa: E402

RANKS = 3
mpiexec, pvserver, pvpython, output = sys.argv[1:]
log = os.path.join(output, "TestServerRanks.log")
# Each rank writes to its own file, because mpiexec mixes lines.
for old in glob.glob(f"{glob.escape(log)}.*"):
    os.remove(old)
with_log = ["sh", "-c", f'exec "$0" "$@" 2>"{log}.$$"', pvserver]
with Server([mpiexec, "-n", str(RANKS), *with_log], log) as server:
    client = os.path.join(HERE, "ServerRanksClient.py")
    subprocess.run([pvpython, client, str(server.port), str(RANKS)], timeout=200, check=True)
    server.wait()
ranks = []
for path in glob.glob(f"{glob.escape(log)}.*"):
    with open(path, encoding="utf-8", errors="replace") as of_rank:
        ranks.append(of_rank.read())
# Count errors, except those of the executives.
counts = [len(re.findall(r"ERR\|(?!.*returned failure for request)", text)) for text in ranks]
if counts != [2] * RANKS:
    sys.exit(f"Expected two errors on each of {RANKS} ranks, not {counts}: {ranks}")
