#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""live-table.py [FILE]: draw what `owsctl watch` shows on a terminal, as docs/img/table.svg or FILE.

A real run: owsd on the simulated house of board/demo, of which one thermometer is unplugged after
a few seconds and one is too hot, and owsctl on a terminal of its own. `make all` comes first.
"""

import fcntl
import html
import os
import pathlib
import pty
import re
import struct
import subprocess
import sys
import tempfile
import termios
import time

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent
BUILD = pathlib.Path(os.environ.get("OWSD_BUILD", SOURCE / "build")).resolve()
PATIENCE = 60
COLUMNS, ROWS = 80, 20
CELL, LINE, MARGIN, BAR = 8.4, 19, 18, 34
PAPER, INK, FAINT, BOLD = "#1b2129", "#d5dbe3", "#8793a3", "#ffffff"
RED, YELLOW = "#ff8f85", "#f2c14e"


def record(folder):
    """The bytes that owsctl watch writes to its terminal."""
    name = f"table{os.getpid()}"
    house = (SOURCE / "board/demo/house.sim").read_text()
    (folder / "house.sim").write_text(house + "\nat 6s unplug bedroom\n")
    rio = (SOURCE / "board/demo/house.rio").read_text()
    rio = re.sub(r"(?<=LimitH) +\d+", " 50", rio)  # the boiler is too hot at once
    (folder / "house.rio").write_text(rio)
    os.environ["OWS_DIR"] = str(folder / "place")
    owsd = subprocess.Popen([BUILD / "owsd-sim", "-n", name, "-c", "house.rio"], cwd=folder,
                            stderr=subprocess.DEVNULL)
    ctl = [BUILD / "owsctl", "-n", name]
    try:
        deadline = time.monotonic() + PATIENCE
        while subprocess.run([*ctl, "get", "key"], capture_output=True, check=False).returncode:
            if time.monotonic() > deadline:
                sys.exit("live-table: owsd does not start")
            time.sleep(0.1)
        subprocess.run([*ctl, "set", "pump", "on"], check=True)
        return on_terminal([*ctl, "watch", "-t", PATIENCE]).replace(name, "OWS")
    finally:
        owsd.terminate()
        owsd.wait(PATIENCE)


def on_terminal(command):
    """What it writes, until it shows that the bedroom's thermometer is gone, and no other."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("4H", ROWS, COLUMNS, 0, 0))
    environment = {**os.environ, "TERM": "xterm"}
    environment.pop("NO_COLOR", None)
    child = subprocess.Popen([str(c) for c in command], stdin=slave, stdout=slave, stderr=slave,
                             env=environment)
    os.close(slave)
    said = b""
    while True:
        try:
            said += os.read(master, 65536)
        except OSError:  # the other side is closed
            break
        if red_names(said.decode(errors="ignore")) == ["bedroom"]:
            child.terminate()
    child.wait(PATIENCE)
    os.close(master)
    return said.decode()


def red_names(said):
    """The signals whose rows are red on the last whole screen."""
    return [text.split()[0] for runs in last_screen(said) for text, attributes in runs[:1]
            if "31" in attributes.split(";") and text.strip()]


def last_screen(said):
    """The lines of the last screen, each a list of (text, attributes): watch writes those that
    changed, each behind its place."""
    screen, lines = {}, []
    for number, text in re.findall(r"\x1b\[(\d+);1H(.*?)(?=\x1b\[\d+;1H|\x1b\[H|$)", said, re.S):
        screen[int(number)] = text
    for _, line in sorted(screen.items()):
        runs, attributes = [], ""
        for part in re.split(r"(\x1b\[[0-9;?]*[A-Za-z])", line):
            sgr = re.fullmatch(r"\x1b\[([0-9;]*)m", part)
            if sgr:
                attributes = "" if sgr[1] in ("", "0") else sgr[1]
            elif part and not part.startswith("\x1b"):
                runs.append((part, attributes))
        if runs:
            lines.append(runs)
    return lines


def style(attributes, number):
    if "31" in attributes.split(";"):
        return f' fill="{RED}"'
    if "33" in attributes.split(";"):
        return f' fill="{YELLOW}"'
    if "1" in attributes.split(";"):
        return f' fill="{BOLD}" font-weight="bold"'
    return f' fill="{FAINT}"' if number == 0 else ""


def draw(lines):
    width = max(sum(len(text) for text, _ in runs) for runs in lines) * CELL + 2 * MARGIN
    height = BAR + (len(lines) + 1) * LINE + MARGIN
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
           f'viewBox="0 0 {width:.0f} {height:.0f}" role="img">',
           "<!-- SPDX-License-Identifier: MIT; made by docs/live-table.py -->",
           "<title>owsctl watch: a table of signals with value, quality, age and path</title>",
           f'<rect x="0.5" y="0.5" width="{width - 1:.0f}" height="{height - 1:.0f}" rx="8" '
           f'fill="{PAPER}" stroke="#4a5563"/>',
           *(f'<circle cx="{MARGIN + 4 + 18 * i}" cy="18" r="5" fill="#4a5563"/>' for i in range(3)),
           '<g font-size="14" xml:space="preserve" font-family="ui-monospace, SFMono-Regular, '
           f'Menlo, Consolas, \'DejaVu Sans Mono\', monospace" fill="{INK}">',
           f'<text x="{MARGIN}" y="{BAR + LINE - 5}" fill="{FAINT}">$ owsctl watch</text>']
    for number, runs in enumerate(lines):
        column, y = 0, BAR + (number + 2) * LINE - 5
        for text, attributes in runs:
            # Each word at its column, whatever the width of the reader's font
            for word in re.finditer(r"\S+(?: \S+)*", text):
                at = MARGIN + (column + word.start()) * CELL
                svg.append(f'<text x="{at:.1f}" y="{y}" textLength="{len(word[0]) * CELL:.1f}"'
                           f'{style(attributes, number)}>{html.escape(word[0])}</text>')
            column += len(text)
    return "\n".join([*svg, "</g>", "</svg>", ""])


def main():
    with tempfile.TemporaryDirectory() as folder:
        lines = last_screen(record(pathlib.Path(folder)))
    file = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "img/table.svg"
    file.write_text(draw(lines))


if __name__ == "__main__":
    main()
