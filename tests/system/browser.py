# SPDX-License-Identifier: MIT
"""Headless Chromium by the WebDriver protocol, with Python's own HTTP client.

    with browser.open_one(scene) as page:
        page.go("http://127.0.0.1:8080/")
        page.until("return document.title === 'Live'", "the title")
        assert not page.complaints()
"""

import base64
import contextlib
import http.client
import json
import shutil
import signal

import owsdtest

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"
KEYS = {"tab": "\ue004", "enter": "\ue007", "escape": "\ue00c", "alt": "\ue00a", "up": "\ue013",
        "down": "\ue015", "left": "\ue012", "right": "\ue014"}


class Fault(AssertionError):
    """What chromedriver refused."""


class Page:
    def __init__(self, port, profile):
        self.port = port
        options = {"args": ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
                            "--disable-dev-shm-usage", "--no-first-run", "--disable-extensions",
                            "--disable-background-networking", "--disable-component-update",
                            "--force-color-profile=srgb", "--lang=en", "--window-size=1280,800",
                            f"--user-data-dir={profile}"],
                   "binary": chromium()}
        session = self.ask("POST", "/session", {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": options,
            "timeouts": {"script": 1000 * owsdtest.PATIENCE, "pageLoad": 1000 * owsdtest.PATIENCE},
            "goog:loggingPrefs": {"browser": "ALL"}}}})
        self.base = f"/session/{session['sessionId']}"
        self.size(1280, 800)

    def ask(self, method, path, body=None):
        """What chromedriver answers."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port,
                                                timeout=owsdtest.PATIENCE + 10)
        with contextlib.closing(connection):
            connection.request(method, path, None if body is None else json.dumps(body),
                               {"Content-Type": "application/json"})
            answer = connection.getresponse()
            value = json.loads(answer.read())["value"]
        if answer.status != 200:
            raise Fault(f"{method} {path}: {value['error']}: {value['message'].splitlines()[0]}")
        return value

    def devtools(self, command, **values):
        return self.ask("POST", f"{self.base}/goog/cdp/execute",
                        {"cmd": command, "params": values})

    def go(self, address):
        self.ask("POST", f"{self.base}/url", {"url": address})

    def tab(self, address=None):
        """The present tab, for show(); with an address a new one, which is shown then."""
        if address:
            self.show(self.ask("POST", f"{self.base}/window/new", {"type": "tab"})["handle"])
            self.go(address)
        return self.ask("GET", f"{self.base}/window")

    def show(self, tab):
        """Show this tab, as a click on it does; the others are hidden then."""
        self.ask("POST", f"{self.base}/window", {"handle": tab})
        # by that chromedriver has a page believe that it is shown for ever
        self.devtools("Emulation.setFocusEmulationEnabled", enabled=False)
        self.devtools("Page.bringToFront")
        self.until("return !document.hidden", "the tab is shown")

    def run(self, script, *arguments):
        """What the script returns; it may return a promise."""
        return self.ask("POST", f"{self.base}/execute/sync",
                        {"script": script, "args": list(arguments)})

    def until(self, script, what, *arguments, seconds=20):
        """Wait until the script returns something true; returns that."""
        return owsdtest.until(lambda: self.run(script, *arguments), seconds, what, step=0.05)

    def find(self, selector):
        """The element that is shown and has this selector, when there is one."""
        return self.until("return [...document.querySelectorAll(arguments[0])]"
                          ".find((one) => one.checkVisibility()) ?? null", selector, selector)

    def click(self, selector):
        # Tables are drawn anew at times: an element may be gone when the click arrives
        def done():
            try:
                self.ask("POST", f"{self.base}/element/{self.find(selector)[ELEMENT]}/click", {})
                return True
            except Fault as fault:
                if "intercepted" in str(fault):
                    # the bar of a phone lies over it
                    self.run("[...document.querySelectorAll(arguments[0])].find((one) =>"
                             "one.checkVisibility())?.scrollIntoView({block: 'center'})", selector)
                elif "stale" not in str(fault):
                    raise
                return False
        owsdtest.until(done, 20, f"a click at {selector}", step=0.1)

    def type(self, selector, text):
        one = self.find(selector)[ELEMENT]
        self.ask("POST", f"{self.base}/element/{one}/clear", {})
        self.ask("POST", f"{self.base}/element/{one}/value", {"text": text})

    def press(self, *keys):
        """Press and release keys: names of KEYS, or characters."""
        actions = [{"type": kind, "value": KEYS.get(key, key)}
                   for key in keys for kind in ("keyDown", "keyUp")]
        self.ask("POST", f"{self.base}/actions",
                 {"actions": [{"type": "key", "id": "keys", "actions": actions}]})

    def chord(self, *keys):
        """Press keys together, the last of them last."""
        codes = [KEYS.get(key, key) for key in keys]
        actions = [{"type": "keyDown", "value": code} for code in codes]
        actions += [{"type": "keyUp", "value": code} for code in reversed(codes)]
        self.ask("POST", f"{self.base}/actions",
                 {"actions": [{"type": "key", "id": "keys", "actions": actions}]})

    def upload(self, selector, path):
        """Choose a file for an input of type file."""
        one = self.find(selector)[ELEMENT]
        self.ask("POST", f"{self.base}/element/{one}/value", {"text": str(path)})

    def drag(self, selector, start, end):
        """Drag over an element, from one part of its width to another (0 to 1)."""
        box = self.run("const b = document.querySelector(arguments[0]).getBoundingClientRect();"
                       "return [b.left, b.top + b.height / 2, b.width]", selector)

        def move(part):
            return {"type": "pointerMove", "duration": 50, "origin": "viewport",
                    "x": round(box[0] + part * box[2]), "y": round(box[1])}
        self.ask("POST", f"{self.base}/actions", {"actions": [{
            "type": "pointer", "id": "mouse", "actions": [
                move(start), {"type": "pointerDown", "button": 0}, move((start + end) / 2),
                move(end), {"type": "pointerUp", "button": 0}]}]})

    def size(self, width, height, mobile=False, scale=1):
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height,
                      deviceScaleFactor=scale, mobile=mobile)

    def scheme(self, name):
        """light or dark"""
        self.devtools("Emulation.setEmulatedMedia",
                      features=[{"name": "prefers-color-scheme", "value": name}])

    def picture(self):
        """The screen as PNG."""
        return base64.b64decode(self.ask("GET", f"{self.base}/screenshot"))

    def complaints(self):
        """Errors and warnings of the console since the last call; also those of the policy."""
        return [entry["message"] for entry in self.ask("POST", f"{self.base}/se/log",
                                                       {"type": "browser"})
                if entry["level"] in ("SEVERE", "WARNING")]


def chromium():
    return shutil.which("chromium") or shutil.which("chromium-browser") \
        or shutil.which("google-chrome")


@contextlib.contextmanager
def open_one(scene):
    """A browser with one page; it ends with the block."""
    if not chromium() or not shutil.which("chromedriver"):
        owsdtest.skip("chromium and chromedriver are not installed (apt install chromium-driver)")
    port = owsdtest.free_port()
    driver = scene.start([shutil.which("chromedriver"), f"--port={port}"],
                         {"HOME": str(scene.path)})
    owsdtest.until(lambda: "started successfully" in driver.log(), 30, driver.log)
    page = Page(port, scene.path / "profile")
    try:
        yield page
    finally:
        with contextlib.suppress(OSError, Fault):
            page.ask("DELETE", page.base)
        driver.signal(signal.SIGTERM)
        driver.wait()
        shutil.rmtree(scene.path / "profile", ignore_errors=True)
