#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What holds in every view of owsd-web's page: it fits a phone, the keyboard reaches it, axe-core
finds nothing, it works below a prefix, and text goes in as text."""

import contextlib
import hashlib
import http.client
import http.server
import io
import re
import shutil
import subprocess
import tarfile
import threading
import urllib.request

import owsdtest
from owsdtest import BUILD, SOURCE, until
from webhouse import CELLS, VIEWS, plant, view

AXE = "axe-core@4.10.3"
AXE_SHA256 = "0f2b4d7dcdf7d1219df8d1959ad68e565f51d14c3f0d88bb71cd59abeb956292"


def test_the_head_names_each_module_that_the_page_begins_with(_scene):
    here = SOURCE / "src/faces/web/page"
    head = (here / "index.html").read_text()
    wanted, left = set(), re.findall(r'<script type="module"[^>]* src="([^"]+)"', head)
    begun = set(left)
    while left:
        name = left.pop()
        wanted.add(name)
        text = (here / name).read_text()
        left += set(re.findall(r'^(?:import|export)[^;(]*? from "\./([^"]+)";', text, re.M)) - wanted
    named = set(re.findall(r'<link rel="modulepreload" href="([^"]+)">', head))
    assert len(begun) == 2 and named == wanted - begun, (
        f"add to index.html {wanted - begun - named}, take out {named - wanted}: a browser would "
        "fetch them one after the other")


def each_view(page):
    for name in VIEWS:
        view(page, name)
        page.until("return document.querySelector('main > section:not([hidden])')"
                   ".querySelector('td, canvas, li, [role=gridcell]')", name)
        yield name


def test_no_view_scrolls_sideways_on_a_phone(scene):
    with plant(scene, write=True) as (_, _, page):
        page.size(360, 740, mobile=True)
        for name in each_view(page):
            page.until("return document.documentElement.scrollWidth <= 360",
                       lambda: f"{name} is " + str(page.run(
                           "return [document.documentElement.scrollWidth, "
                           "...[...document.querySelectorAll('main *, header *')].filter((one) => "
                           "one.getBoundingClientRect().right > 361).map((one) => one.tagName + '.'"
                           " + one.className)].slice(0, 9)")))
        assert not page.complaints()


def test_the_keyboard_reaches_every_view_and_shows_where_it_is(scene):
    with plant(scene) as (_, _, page):
        reached = []
        for _ in range(12):
            page.press("tab")
            reached.append(page.run("const a = document.activeElement;"
                                    "return [a.getAttribute('href') ?? a.id ?? a.tagName,"
                                    "getComputedStyle(a).outlineStyle]"))
        names = [name for name, _ in reached]
        assert names[0] == "#main" and names[1:7] == [f"#{name}" for name in VIEWS], names
        assert all(style != "none" for _, style in reached[:7]), reached


def axe():
    """The rules of axe-core as a script."""
    place = BUILD / "cache"
    script = place / "axe.min.js"
    if not script.exists():
        if not shutil.which("npm"):
            owsdtest.skip("axe-core is not there, and npm, which would fetch it, neither")
        place.mkdir(parents=True, exist_ok=True)
        done = subprocess.run(["npm", "pack", "--silent", AXE], cwd=place, text=True, timeout=120,
                              capture_output=True, check=False)
        if done.returncode:
            owsdtest.skip(f"axe-core cannot be fetched: {done.stderr.strip()[-100:]}")
        packed = (place / done.stdout.strip().split("\n")[-1])
        content = packed.read_bytes()
        assert hashlib.sha256(content).hexdigest() == AXE_SHA256, "another axe-core"
        with tarfile.open(fileobj=io.BytesIO(content)) as archive:
            script.write_bytes(archive.extractfile("package/axe.min.js").read())
        packed.unlink()
    return script.read_text()


def test_axe_finds_nothing_in_any_view_light_dark_or_small(scene):
    rules = axe()
    with plant(scene, write=True) as (_, _, page):
        until(lambda: page.run(CELLS)["attic"]["quality"] == "device absent", 30, "absent")
        page.run(rules)
        found = []
        for scheme, width in (("light", 1280), ("dark", 1280), ("light", 360), ("dark", 360)):
            page.scheme(scheme)
            page.size(width, 800)
            for name in each_view(page):
                found += [(scheme, width, name, fault) for fault in page.run(
                    "return axe.run(document).then((r) => r.violations.flatMap((v) => v.nodes.map("
                    "(n) => `${v.id}: ${n.target}: ${n.failureSummary}`)))")]
        view(page, "live")
        page.click("[aria-label='Set others']:enabled")
        found += page.run("return axe.run(document).then((r) => r.violations.map((v) => v.id))")
        assert not found, "\n".join(map(str, found))


class Prefix(http.server.BaseHTTPRequestHandler):
    """A reverse proxy that has the page below /a/prefix/, as Home Assistant's ingress does."""
    target = ""

    def do_GET(self):
        if not self.path.startswith("/a/prefix/"):
            self.send_error(404)
            return
        with contextlib.suppress(OSError, http.client.HTTPException):
            with urllib.request.urlopen(self.target + self.path[10:], timeout=30) as answer:
                self.send_response(answer.status)
                for key in ("Content-Type", "Content-Security-Policy"):
                    if answer.headers[key]:
                        self.send_header(key, answer.headers[key])
                self.end_headers()
                while part := answer.read1(4096):
                    self.wfile.write(part)

    def log_message(self, *_):
        pass


def test_the_page_works_below_a_prefix(scene):
    with plant(scene) as (_, web, page):
        handler = type("Here", (Prefix,), {"target": web.address})
        proxy = http.server.ThreadingHTTPServer(("127.0.0.1", owsdtest.free_port()), handler)
        proxy.daemon_threads = True
        threading.Thread(target=proxy.serve_forever, daemon=True).start()
        page.go(f"http://127.0.0.1:{proxy.server_port}/a/prefix/")
        until(lambda: page.run(CELLS).get("room", {}).get("value") == "21.5", 20, "room")
        for name in each_view(page):
            assert name in VIEWS
        assert not page.complaints()
        page.go("about:blank")
        proxy.shutdown()
        proxy.server_close()


if __name__ == "__main__":
    owsdtest.main(at_once=2)
