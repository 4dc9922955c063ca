# SPDX-License-Identifier: MIT
"""Headless Firefox by its own protocol, Marionette: the commands of WebDriver, as lines of JSON on a
TCP connection. A page of it does what one of browser.py does."""

import contextlib
import json
import re
import shutil
import signal
import socket

import browser
import owsdtest

# HTTP path of WebDriver, after that of the session -> command of Marionette
COMMANDS = {"url": "Navigate", "execute/sync": "ExecuteScript", "actions": "PerformActions",
            "timeouts": "SetTimeouts", "screenshot": "TakeScreenshot"}
PREFERENCES = """user_pref("marionette.port", %d);
user_pref("browser.shell.checkDefaultBrowser", false);
user_pref("browser.startup.page", 0);
user_pref("datareporting.policy.dataSubmissionEnabled", false);
user_pref("network.captive-portal-service.enabled", false);
user_pref("network.connectivity-service.enabled", false);
user_pref("services.settings.server", "");
user_pref("app.normandy.enabled", false);
user_pref("browser.safebrowsing.update.enabled", false);
"""
# What the console has of pages below an address since the last call. Not that a stream ended when
# its page was left
COMPLAINTS = """const found = [];
    for (const one of Services.console.getMessageArray()) {
        if (one instanceof Ci.nsIScriptError && one.sourceName.startsWith(arguments[0])
            && !(one.flags & Ci.nsIScriptError.infoFlag))
            found.push(`${one.sourceName}:${one.lineNumber}: ${one.errorMessage}`);
    }
    Services.console.reset();
    return found;"""


class Page(browser.Page):
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=owsdtest.PATIENCE)
        self.left, self.number, self.base, self.origin = b"", 0, "", "http://127.0.0.1"
        self.receive()
        self.command("WebDriver:NewSession", {})

    def receive(self):
        """A message: its length, a colon, JSON."""
        def more():
            part = self.socket.recv(65536)
            assert part, "Firefox closed the connection"
            self.left += part
        while b":" not in self.left:
            more()
        length, self.left = self.left.split(b":", 1)
        while len(self.left) < int(length):
            more()
        text, self.left = self.left[:int(length)], self.left[int(length):]
        return json.loads(text)

    def command(self, name, values):
        self.number += 1
        text = json.dumps([0, self.number, name, values]).encode()
        self.socket.sendall(b"%d:%s" % (len(text), text))
        _, number, error, value = self.receive()
        assert number == self.number, (number, self.number)
        if error:
            raise browser.Fault(f"{name}: {error['error']}: {error['message'].splitlines()[0]}")
        return value["value"] if isinstance(value, dict) and list(value) == ["value"] else value

    def ask(self, method, path, body=None):
        path = path.removeprefix("/")
        if element := re.fullmatch("element/(.+)/(click|clear|value)", path):
            name = {"click": "Click", "clear": "Clear", "value": "SendKeys"}[element[2]]
            return self.command(f"WebDriver:Element{name}", {"id": element[1], **(body or {})})
        return self.command(f"WebDriver:{COMMANDS[path]}", body or {})

    def within_firefox(self, script, *arguments):
        """What a script of the browser itself returns."""
        self.command("Marionette:SetContext", {"value": "chrome"})
        try:
            return self.run(script, *arguments)
        finally:
            self.command("Marionette:SetContext", {"value": "content"})

    def size(self, width, height, mobile=False, scale=1):
        self.within_firefox("""const {style} = gBrowser.selectedBrowser;
            for (const [key, value] of Object.entries(arguments[0]))
                for (const least of ["", "min-", "max-"])
                    style.setProperty(least + key, `${value}px`);""",
                            {"width": width, "height": height})
        self.until("return innerWidth === arguments[0]", f"a width of {width}", width)

    def complaints(self):
        return self.within_firefox(COMPLAINTS, self.origin)


@contextlib.contextmanager
def open_one(scene):
    """A Firefox with one page; it ends with the block."""
    program = shutil.which("firefox-esr") or shutil.which("firefox")
    if not program:
        owsdtest.skip("Firefox is not installed (apt install firefox-esr)")
    port, profile = owsdtest.free_port(), scene.path / "firefox"
    profile.mkdir()
    (profile / "user.js").write_text(PREFERENCES % port)
    running = scene.start([program, "--headless", "--no-remote", "--marionette",
                           "--remote-allow-system-access", "--profile", profile],
                          {"HOME": str(scene.path), "MOZ_CRASHREPORTER_DISABLE": "1"})

    def listens():
        assert running.running(), running.log()
        with contextlib.suppress(OSError):
            socket.create_connection(("127.0.0.1", port), timeout=5).close()
            return True
    owsdtest.until(listens, 60, running.log)
    page = Page(port)
    try:
        yield page
    finally:
        with contextlib.suppress(OSError, AssertionError):
            page.command("Marionette:Quit", {"flags": ["eForceQuit"]})
        page.socket.close()
        with contextlib.suppress(owsdtest.Late):
            running.wait()
        running.signal(signal.SIGKILL)
        shutil.rmtree(profile, ignore_errors=True)
