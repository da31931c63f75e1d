# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-interactive replays a recording that is dropped onto its window, as file managers drop files, and
ends a recording that is dropped while it is written. The client that drops the file disconnects before the replay.
Usage: TestDrop.py PROGRAM FOLDER"""
import os
import subprocess
import sys
import time

try:
    from Xlib import X, display
    from Xlib.protocol import event
except ImportError:
    print("Skipped: there is no Python module Xlib. Install python3-xlib.")
    sys.exit(125)

from Volumes import begin_test, make_ball, write_vti
from WindowEvents import WindowEvents

PATIENCE = 100.0  # time limit of wait_for(), in seconds
program, path = begin_test("Drop")


def wait_for(find):
    """Calls find() until it returns a value, and returns this value."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = find()
        if found:
            return found
        assert running.poll() is None, (running.returncode, running.communicate())
        time.sleep(0.05)
    raise AssertionError(f"the expected result was not there within {PATIENCE} seconds")


class Source:
    """A client of the X server that drags a file, by version 5 of the protocol XDND."""

    def __init__(self):
        self.display = display.Display()
        root = self.display.screen().root
        self.window = root.create_window(0, 0, 1, 1, 0, self.display.screen().root_depth)
        self.window.set_selection_owner(self.atom("XdndSelection"), X.CurrentTime)
        self.target = wait_for(lambda: self.find(root))

    def atom(self, name):
        return self.display.intern_atom(name)

    def find(self, window):
        """Returns the window at or below the given one that accepts drops."""
        if window.get_full_property(self.atom("XdndAware"), X.AnyPropertyType):
            return window
        return next(filter(None, map(self.find, window.query_tree().children)), None)

    def tell(self, name, *numbers):
        data = (32, [self.window.id] + list(numbers) + [0] * (4 - len(numbers)))
        self.target.send_event(event.ClientMessage(window=self.target, client_type=self.atom(name),
                                                   data=data), event_mask=0)
        self.display.flush()

    def await_event(self, kind):
        def find():
            while self.display.pending_events():
                found = self.display.next_event()
                if found.type & 0x7f == kind:
                    return found
            return None
        return wait_for(find)

    def press(self, key):
        self.target.send_event(event.KeyPress(
            time=X.CurrentTime, root=self.display.screen().root, window=self.target, same_screen=1, child=X.NONE,
            root_x=20, root_y=20, event_x=20, event_y=20, state=0,
            detail=self.display.keysym_to_keycode(ord(key))), event_mask=0)
        self.display.flush()

    def drop(self, name):
        self.tell("XdndEnter", 5 << 24, self.atom("text/uri-list"))
        self.tell("XdndPosition", 0, 20 << 16 | 20, X.CurrentTime, self.atom("XdndActionCopy"))
        self.await_event(X.ClientMessage)
        self.tell("XdndDrop", 0, X.CurrentTime)
        request = self.await_event(X.SelectionRequest)
        request.requestor.change_property(request.property, request.target, 8,
                                          f"file://{name}\r\n".encode())
        request.requestor.send_event(event.SelectionNotify(
            time=request.time, requestor=request.requestor, selection=request.selection,
            target=request.target, property=request.property))
        self.display.flush()
        answer = self.await_event(X.ClientMessage)
        assert answer.client_type == self.atom("XdndFinished"), (answer.client_type, self.atom("XdndFinished"))
        self.display.close()


write_vti(make_ball(dimensions=(31, 28, 25), spacing=(1.0, 1.0, 1.0)), path("ball.vti"))
WindowEvents().keys("s").wait(2).write(path("events.log"))
for name, options, saved in (("events.log", [], "ball-deformed-1.xml"),
                             ("written.log", ["--record", path("written.log")], "ball-deformed-3.xml")):
    with subprocess.Popen([program, path("ball.vti"), "--size", "200,200"] + options, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, cwd=path()) as running:
        try:
            source = Source()
            if options:
                source.press("s")
                wait_for(lambda: os.path.exists(path("ball-deformed-2.xml")))
            source.drop(path(name))
            wait_for(lambda: os.path.exists(path(saved)))
            size = os.path.getsize(path(name))
            time.sleep(1.0)
            assert os.path.getsize(path(name)) == size, "the recording goes on: its replay would never end"
        finally:
            running.kill()
