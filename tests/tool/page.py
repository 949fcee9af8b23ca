#!/usr/bin/env python3
"""page.py TOOL - pages that `extract -o FILE.html` and `labels` write, in Chromium

Chromium shows them without a window and is asked through a pipe (Chrome DevTools Protocol) for pictures, for what its
console says, and for what it would load. A sphere is a disc of its outer colour, an open surface shows both; turned,
zoomed and set back it shows what it should; nothing is loaded but the page itself, and the console stays empty. Pages
with a planted fault, and a browser without WebGL, are noticed. 77 without Chromium.
"""
import base64
import fcntl
import json
import os
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from png import png_read
from tool_case import GridCase

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
FLAGS = ["--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--disable-background-networking", "--no-first-run", "about:blank"]
SIDE = 400
PATIENCE = 120


class Browser:
    """One tab of Chromium; what its console says, and the addresses that it asks for."""

    def __init__(self, folder, *flags):
        (commands, self.to), (self.of, answers) = os.pipe(), os.pipe()
        high = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (commands, answers)]

        def begin():
            os.dup2(high[0], 3)
            os.dup2(high[1], 4)
        self.process = subprocess.Popen([CHROMIUM, f"--user-data-dir={folder}", *flags, *FLAGS], preexec_fn=begin,
                                        start_new_session=True, pass_fds=(3, 4), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in (commands, answers, *high):
            os.close(end)
        self.number, self.unread, self.session, self.said, self.asked = 0, b"", None, [], []
        self.events = set()
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for part in ("Runtime", "Log", "Network", "Page"):
            self.call(f"{part}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=SIDE, height=SIDE, deviceScaleFactor=1, mobile=False)

    def message(self):
        os.set_blocking(self.of, False)
        end = time.monotonic() + PATIENCE
        while b"\0" not in self.unread:
            try:
                more = os.read(self.of, 1 << 20)
            except BlockingIOError:
                more = None
                time.sleep(0.005)
            if more == b"" or time.monotonic() > end:
                raise RuntimeError("Chromium does not answer")
            self.unread += more or b""
        text, self.unread = self.unread.split(b"\0", 1)
        return json.loads(text)

    def take(self):
        """The next message; of events what matters is kept."""
        m = self.message()
        method, about = m.get("method", ""), m.get("params", {})
        self.events.add(method)
        if method == "Network.requestWillBeSent":
            self.asked.append(about["request"]["url"])
        if method in ("Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"):
            self.said.append(json.dumps(about))
        return m

    def call(self, method, **about):
        self.number += 1
        m = {"id": self.number, "method": method, "params": about}
        if self.session:
            m["sessionId"] = self.session
        os.write(self.to, json.dumps(m).encode() + b"\0")
        while True:
            answer = self.take()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def run(self, text):
        return self.call("Runtime.evaluate", expression=text, awaitPromise=True, returnByValue=True)["result"].get("value")

    def settle(self):
        """Until what was drawn last is on the screen."""
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50))))")

    def show(self, path):
        self.said.clear()
        self.asked.clear()
        self.events.discard("Page.loadEventFired")
        self.call("Page.navigate", url="file://" + path)
        while "Page.loadEventFired" not in self.events:
            self.take()
        self.settle()

    def picture(self):
        """Pixels without the line of text."""
        self.run("document.querySelector('p').style.visibility = 'hidden'")
        self.settle()
        return png_read(base64.b64decode(self.call("Page.captureScreenshot")["data"]))[2]

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def drag(self, dx, dy, **more):
        x, y = SIDE / 2, SIDE / 2
        self.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1, **more)
        for n in range(1, 6):
            self.mouse("mouseMoved", x + dx * n / 5, y + dy * n / 5, button="left", buttons=1, **more)
        self.mouse("mouseReleased", x + dx, y + dy, button="left", buttons=0, clickCount=1, **more)

    def close(self):
        os.killpg(self.process.pid, signal.SIGKILL)  # also what else writes to the profile
        self.process.wait()
        os.close(self.to)
        os.close(self.of)


def count(picture, what):
    return sum(what(*pixel) for row in picture for pixel in row)


def is_outer(r, g, b):
    return b > r + 30


def is_inner(r, g, b):
    return r > b + 30


def is_shown(r, g, b):
    return min(r, g, b) < 250


class Page(GridCase):
    def setUp(self):
        super().setUp()
        self.browser = None

    def tearDown(self):
        if self.browser:
            self.browser.close()
        super().tearDown()

    def begin(self, *flags):
        self.browser = Browser(self.path("profile"), *flags)
        return self.browser

    def page(self, field, *more, iso="127.5", name="a.html"):
        volume = self.generate(field, f"{field}.nrrd", "40,40,40")
        self.expect(0, "extract", volume, "--iso", iso, "--engine", "reference", "--quiet", "-o", self.path(name), *more)
        return self.path(name)

    def expect_quiet(self, path):
        self.assertEqual((self.browser.said, [url for url in self.browser.asked if url != "data:,"]), ([], ["file://" + path]))

    def test_sphere(self):
        browser = self.begin()
        for more in ([], ["--normals"], ["--soup"], ["--method", "snap"]):
            path = self.page("sphere", *more)
            browser.show(path)
            picture = browser.picture()
            shown, outer = count(picture, is_shown), count(picture, is_outer)
            self.assertLess(count(picture, is_inner), 20, more)  # at the outline
            self.assertGreater(outer, 0.9 * shown, more)
            columns = [any(is_shown(*row[x]) for row in picture) for x in range(SIDE)]
            self.assertAlmostEqual(shown, 0.785 * sum(columns) ** 2, delta=0.03 * shown, msg=more)  # a disc
            self.expect_quiet(path)
            self.assertIn("triangles", browser.run("document.querySelector('p').textContent"))

    def test_turned_and_zoomed(self):
        browser = self.begin()
        path = self.page("gyroid")
        browser.show(path)
        first = browser.picture()
        self.assertGreater(min(count(first, is_outer), count(first, is_inner)), 5000)
        changes = {
            "turned": lambda: browser.drag(80, 0), "lifted": lambda: browser.drag(0, 60),
            "moved": lambda: browser.drag(60, 0, modifiers=8),
            "zoomed": lambda: browser.mouse("mouseWheel", 200, 200, deltaX=0, deltaY=-500),
            "key": lambda: browser.call("Input.dispatchKeyEvent", type="keyDown", key="ArrowLeft")}
        browser.run("document.querySelector('canvas').focus()")
        for name, change in changes.items():
            change()
            other = browser.picture()
            differ = sum(a != b for rows in zip(first, other) for a, b in zip(*rows))
            self.assertGreater(differ, 10000, name)
            if name == "zoomed":
                self.assertGreater(count(other, is_shown), 1.3 * count(first, is_shown))
            browser.call("Input.dispatchKeyEvent", type="keyDown", key="0")
            self.assertEqual(browser.picture(), first, f"after {name}: not as before")
        self.expect_quiet(path)

    def test_labels(self):
        """Two boxes side by side: each has a colour of its own, and goes where its box of the list is not checked; of
        what is left the wall between them has its colour."""
        browser = self.begin()
        values = [(1 if x < 6 else 2) if 1 <= x < 11 and 1 <= y < 5 and 1 <= z < 5 else 0
                  for z in range(6) for y in range(6) for x in range(12)]
        raw, path = self.raw("two.raw", "u8", (12, 6, 6), values), self.path("two.html")
        self.expect(0, "labels", *raw, "--smooth", "0", "--engine", "reference", "--quiet", "-o", path)
        browser.show(path)
        self.assertEqual(browser.run("document.querySelector('ul').innerText.trim().split(/\\s+/)"), ["1", "2"])
        browser.run("document.querySelector('ul').style.visibility = 'hidden'")

        def hues():
            """How many pixels have each channel as their strongest."""
            found = [0, 0, 0]
            for pixel in (pixel for row in browser.picture() for pixel in row if is_shown(*pixel)):
                found[pixel.index(max(pixel))] += 1
            return found

        def click(n):
            browser.run(f"document.querySelectorAll('ul input')[{n}].click()")
            browser.settle()
        both = hues()
        click(0)
        second = hues()
        click(1)
        self.assertEqual(sum(hues()), 0)
        click(0)
        first = hues()
        of_first, of_second = first.index(max(first)), second.index(max(second))
        self.assertNotEqual(of_first, of_second)
        for alone, channel in ((first, of_first), (second, of_second)):
            self.assertGreater(alone[channel], 0.97 * sum(alone))
            self.assertGreater(both[channel], 5000)
        click(1)
        self.assertEqual(hues(), both)
        self.expect_quiet(path)
        self.expect(0, "labels", *raw, "--separate", "--engine", "reference", "--quiet", "-o", self.path("box%.html"))
        browser.show(self.path("box1.html"))  # of one label: nothing to choose
        self.assertIs(browser.run("document.querySelector('ul').hidden"), True)
        self.assertEqual(sum(hues()) > 5000 and hues().index(max(hues())), of_first)

    def test_empty(self):
        browser = self.begin()
        path = self.page("empty")
        browser.show(path)
        self.assertEqual(count(browser.picture(), is_shown), 0)
        self.assertIn("0 triangles", browser.run("document.querySelector('p').textContent"))
        self.expect_quiet(path)

    def test_planted(self):
        """A shader that does not compile, data that are cut short, an address that is asked for."""
        browser = self.begin()
        with open(self.page("sphere"), encoding="utf-8") as file:
            good = file.read()
        for old, new, says in (("out vec4 colour;", "out vec5 colour;", "cannot be shown"),
                               ('id="triangles">', 'id="corners">', "cannot be shown"),
                               ("<body>", '<body><img src="http://127.0.0.1:9/x.png">', "")):
            self.assertEqual(good.count(old), 1, old)
            path = self.write("bad.html", good.replace(old, new))
            browser.show(path)
            self.assertIn(says, browser.run("document.querySelector('p').textContent"))
            self.assertTrue(browser.said, new)

    def test_without_webgl(self):
        browser = self.begin("--disable-3d-apis")
        browser.show(self.page("sphere"))
        self.assertIn("has no WebGL 2", browser.run("document.querySelector('p').textContent"))


if __name__ == "__main__":
    if not CHROMIUM:
        print("no Chromium: pages were not shown")
        sys.exit(77)
    tool_case.main()
