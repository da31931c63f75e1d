# SPDX-License-Identifier: BSD-3-Clause
"""Writes events of a window in the format that vtkInteractorEventRecorder reads."""


class WindowEvents:
    """Records events. A timer event, which is a step of the session, follows each event except those of keys."""

    def __init__(self):
        self.place = (0, 0)  # position of the cursor
        self.text = "# StreamVersion 1.1\n"
        self.wait(1)

    def mouse(self, name, place, shift=False):
        self.place = place
        self.text += f"{name} {place[0]:.0f} {place[1]:.0f} {int(shift)} 0 0 0\n"
        return self.wait(1)

    def stroke(self, *places, steps=4, shift=False):
        """Drags from position to position with the left button."""
        self.mouse("LeftButtonPressEvent", places[0])
        for begin, end in zip(places, places[1:]):
            for step in range(1, steps + 1):
                self.mouse("MouseMoveEvent",
                           [a + (b - a) * step / steps for a, b in zip(begin, end)])
        return self.mouse("LeftButtonReleaseEvent", places[-1], shift)

    def turn(self, begin, end, steps=4):
        """Turns the camera with the right button."""
        self.mouse("RightButtonPressEvent", begin)
        for step in range(1, steps + 1):
            self.mouse("MouseMoveEvent", [a + (b - a) * step / steps for a, b in zip(begin, end)])
        return self.mouse("RightButtonReleaseEvent", end)

    def keys(self, text, place=None):
        self.place = place or self.place
        for key in text:
            self.text += f"CharEvent {self.place[0]:.0f} {self.place[1]:.0f} 0 {ord(key)} 0 0\n"
        return self

    def wait(self, steps):
        self.text += steps * f"TimerEvent {self.place[0]:.0f} {self.place[1]:.0f} 0 0 0 0\n"
        return self

    def write(self, path):
        with open(path, "w", encoding="ascii") as file:
            file.write(self.text)
