#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""alarm-states.py [alarm_fsm.c]: draw the alarm machine's table as an SVG on the standard output.

What is drawn, and the words at the arrows, comes from the table; only places and ways of the lines
stand here. A row of the table that has no line, and a line that has no row, are errors.
"""

import html
import pathlib
import re
import sys

TABLE = pathlib.Path(__file__).parent.parent / "src/daemon/engine/alarm/alarm_fsm.c"
WIDTH, HEIGHT, PITCH = 900, 1040, 92
BOX_W, BOX_H = 196, 38
LEFT, RIGHT, LEFT_RAIL, RIGHT_RAIL = 170, 510, 36, 858

# Column and row of each state
PLACES = {
    "NOT_USED": (LEFT, 0),
    "INIT": (LEFT, 1), "ALARM_DIR": (RIGHT, 1),
    "ALARM_PROCESS": (LEFT, 2), "ALARM_BYPASS": (RIGHT, 2),
    "ALARM_POR_READ": (LEFT, 3), "ALARM_POR_READ_WAIT": (RIGHT, 3),
    "ALARM_SET": (LEFT, 4), "ALARM_SET_WAIT": (RIGHT, 4),
    "ALARM_INIT_WRITE_WAIT": (RIGHT + 50, 5),
    "ALARM_POR_RESET": (LEFT, 6), "ALARM_POR_RESET_WAIT": (RIGHT, 6),
    "ALARM_LATCH": (LEFT, 7), "ALARM_LATCH_WAIT": (RIGHT, 7),
    "ALARM_SENSED": (LEFT, 8), "ALARM_SENSED_WAIT": (RIGHT, 8),
    "ALARM_LATCH_RESET": (LEFT, 9), "ALARM_LATCH_RESET_WAIT": (RIGHT, 9),
    "SENSED": (LEFT, 10), "SENSED_WAIT": (RIGHT, 10),
}
# A fact in words: alone, and where an earlier row of the state has the same fact and another
WORDS = {
    "ITEMS": "an alarm item", "STARTED": "started", "FAILED": "failed", "DONE": "done",
    "MAX_CONS": "MaxConsAlarms", "NEXT_ITEM": "next item", "CYCLE_END": "end of the cycle",
    "ND": "not defined", "EMPTY": "empty", "KNOWN": "done before", "PASSED": "else",
    "DONE NON_ZERO": "not 0", "KNOWN NON_ZERO": "was not 0", "DONE INIT_OUTPUT": "another output",
    "DONE INIT_POS": "done", "DONE !INIT_POS": "iAlarmInitPos < 0",
    "PASSED POS": "iAlarmPos \u2265 0",
}
REST = {("DONE", "NON_ZERO"): "0", ("KNOWN", "NON_ZERO"): "was 0",
        ("DONE", "INIT_OUTPUT"): "no further output"}


def read_table(path):
    """The rows: state, facts as words, next state, whether it is a ruling of ours."""
    text = pathlib.Path(path).read_text()
    body = text[text.index("alarm_table[] = {"):]
    body = body[:body.index("\n};")]
    rows = []
    for state, facts, none, after, ruling in re.findall(
            r"\{(\w+), ([\w |]+), (\w+), (\w+),\s*(RULING )?\"[^\"]*\"\}", body):
        names = [f.removeprefix("FACT_") for f in facts.split(" | ")]
        if none != "0":
            names.append("!" + none.removeprefix("FACT_"))
        earlier = [r[1] for r in rows if r[0] == state]
        words = WORDS[" ".join(names)]
        for (fact, other), rest in REST.items():
            if names == [fact] and [fact, other] in earlier:
                words = rest
        rows.append((state, names, after, bool(ruling), words))
    if len(rows) != body.count("\n\t{"):
        sys.exit(f"{path}: {body.count(chr(10) + chr(9) + '{ ')} rows, and {len(rows)} understood")
    return rows


def read_numbers(path):
    """The state's numbers, which are the manual's; the first is -1."""
    text = pathlib.Path(path).with_suffix(".h").read_text()
    names = re.findall(r"^\tX\((\w+)\)", text, re.M)
    if set(names) != set(PLACES):
        sys.exit(f"{path}: the states {set(names) ^ set(PLACES)} are there or here alone")
    return {name: number for number, name in enumerate(names, -1)}


def top(state):
    return 24 + PLACES[state][1] * PITCH


def middle(state):
    return top(state) + BOX_H // 2


def bottom(state):
    return top(state) + BOX_H


def gap(state):
    """The height half-way between the state's row and the next."""
    return bottom(state) + (PITCH - BOX_H) // 2


def is_left(state):
    return PLACES[state][0] == LEFT


# --- Ways of lines: points, then where the words stand and how -----------------------------------

def across(a, b, dy=0):
    """To the box on the right, or back."""
    y = middle(a) + dy
    if is_left(a):
        return [(LEFT + BOX_W, y), (RIGHT, y)], (LEFT + BOX_W + 70, y - 5, "middle")
    return [(RIGHT, y), (LEFT + BOX_W, y)], (LEFT + BOX_W + 70, y + 13, "middle")


def down(a, b):
    """To the box below."""
    return [(LEFT + 60, bottom(a)), (LEFT + 60, top(b))], (LEFT + 66, bottom(a) + 17, "start")


def slanted(a, b, leave=30):
    """From the box on the right to the left one below."""
    x, y = PLACES[a][0] + leave, top(b) - (PITCH - BOX_H) // 2
    return ([(x, bottom(a)), (x, y), (LEFT + 166, y), (LEFT + 166, top(b))],
            (x - 8, y - 5, "end"))


def rail(a):
    """To the next alarm, by the rail of its side."""
    y = middle(a)
    if is_left(a):
        return [(LEFT, y), (LEFT_RAIL, y)], (LEFT_RAIL + 8, y - 5, "start")
    return [(RIGHT + BOX_W, y), (RIGHT_RAIL, y)], (RIGHT + BOX_W + 6, y - 5, "start")


def ways():
    """(from, to): points, words; of lines to a rail the last point has no arrow."""
    over, out = gap("NOT_USED"), RIGHT + BOX_W + 40
    skip = 796
    made = {
        ("ALARM_DIR", "ALARM_BYPASS"): ([(RIGHT + 130, bottom("ALARM_DIR")),
                                         (RIGHT + 130, top("ALARM_BYPASS"))],
                                        (RIGHT + 136, gap("ALARM_DIR") + 4, "start")),
        ("ALARM_PROCESS", "ALARM_BYPASS"): across("ALARM_PROCESS", "ALARM_BYPASS", -10),
        ("ALARM_BYPASS", "ALARM_PROCESS"): across("ALARM_BYPASS", "ALARM_PROCESS", 10),
        ("ALARM_BYPASS", "INIT"): ([(RIGHT + BOX_W, middle("ALARM_BYPASS")),
                                    (out, middle("ALARM_BYPASS")), (out, over),
                                    (LEFT + 130, over), (LEFT + 130, top("INIT"))],
                                   (RIGHT + BOX_W + 6, middle("ALARM_BYPASS") - 5, "start")),
        ("INIT", "ALARM_BYPASS"): ([(LEFT + BOX_W, middle("INIT") + 12),
                                    (RIGHT - 16, middle("INIT") + 12),
                                    (RIGHT - 16, middle("ALARM_BYPASS") - 16),
                                    (RIGHT, middle("ALARM_BYPASS") - 16)],
                                   (LEFT + BOX_W + 70, middle("INIT") + 25, "middle")),
        ("ALARM_POR_READ", "ALARM_LATCH"): ([(LEFT, middle("ALARM_POR_READ") + 12),
                                             (LEFT - 22, middle("ALARM_POR_READ") + 12),
                                             (LEFT - 22, middle("ALARM_LATCH") - 12),
                                             (LEFT, middle("ALARM_LATCH") - 12)],
                                            (LEFT - 28, gap("ALARM_POR_READ"), "end")),
        ("ALARM_POR_READ_WAIT", "ALARM_LATCH"): (
            [(RIGHT + BOX_W, middle("ALARM_POR_READ_WAIT") + 12),
             (skip, middle("ALARM_POR_READ_WAIT") + 12), (skip, gap("ALARM_POR_RESET")),
             (LEFT + 166, gap("ALARM_POR_RESET")), (LEFT + 166, top("ALARM_LATCH"))],
            (RIGHT + BOX_W + 6, middle("ALARM_POR_READ_WAIT") + 25, "start")),
        ("ALARM_SET_WAIT", "ALARM_INIT_WRITE_WAIT"): (
            [(RIGHT + 90, bottom("ALARM_SET_WAIT")), (RIGHT + 90, top("ALARM_INIT_WRITE_WAIT"))],
            (RIGHT + 84, gap("ALARM_SET_WAIT") + 4, "end")),
        ("ALARM_INIT_WRITE_WAIT", "ALARM_SET_WAIT"): (
            [(RIGHT + 150, top("ALARM_INIT_WRITE_WAIT")), (RIGHT + 150, bottom("ALARM_SET_WAIT"))],
            (RIGHT + 156, gap("ALARM_SET_WAIT") + 4, "start")),
        ("ALARM_SET_WAIT", "ALARM_POR_RESET"): (
            [(RIGHT, middle("ALARM_SET_WAIT") + 12), (RIGHT - 22, middle("ALARM_SET_WAIT") + 12),
             (RIGHT - 22, gap("ALARM_INIT_WRITE_WAIT")),
             (LEFT + 166, gap("ALARM_INIT_WRITE_WAIT")), (LEFT + 166, top("ALARM_POR_RESET"))],
            (RIGHT - 28, middle("ALARM_INIT_WRITE_WAIT"), "end")),
        ("ALARM_INIT_WRITE_WAIT", "ALARM_POR_RESET"): slanted("ALARM_INIT_WRITE_WAIT",
                                                              "ALARM_POR_RESET", 116),
    }
    for a, b in (("NOT_USED", "INIT"), ("ALARM_PROCESS", "ALARM_POR_READ"),
                 ("ALARM_POR_READ", "ALARM_SET"), ("ALARM_SET", "ALARM_POR_RESET"),
                 ("ALARM_POR_RESET", "ALARM_LATCH"), ("ALARM_LATCH", "ALARM_SENSED"),
                 ("ALARM_SENSED", "ALARM_LATCH_RESET"), ("ALARM_LATCH_RESET", "SENSED")):
        made[a, b] = down(a, b)
    for a, b in (("ALARM_DIR", "ALARM_PROCESS"), ("ALARM_POR_READ_WAIT", "ALARM_SET"),
                 ("ALARM_POR_RESET_WAIT", "ALARM_LATCH"), ("ALARM_LATCH_WAIT", "ALARM_SENSED"),
                 ("ALARM_SENSED_WAIT", "ALARM_LATCH_RESET"), ("ALARM_LATCH_RESET_WAIT", "SENSED")):
        made[a, b] = slanted(a, b)
    made["INIT", "ALARM_DIR"] = across("INIT", "ALARM_DIR")
    for a in PLACES:
        if a + "_WAIT" in PLACES:
            made[a, a + "_WAIT"] = across(a, a + "_WAIT")
        if PLACES[a][1] > 2 and a != "ALARM_INIT_WRITE_WAIT":
            made[a, "ALARM_PROCESS"] = rail(a)
    return made


# --- The picture ----------------------------------------------------------------------------------

STYLE = """
svg { font-family: sans-serif; font-size: 11.5px; }
.page { fill: #ffffff; } text { fill: #1f2328; }
.state { fill: #f3f4f6; stroke: #57606a; } .waits { fill: #ddf4ff; stroke: #0969da; }
.name { font-family: monospace; font-size: 12px; }
.line { fill: none; stroke: #57606a; stroke-width: 1.4; } .rail { stroke-width: 2.6; }
.ours { stroke-dasharray: 5 3; } tspan.ours, text.ours { font-style: italic; fill: #9a5300; }
.head { fill: #57606a; } .quiet { fill: #57606a; }
@media (prefers-color-scheme: dark) {
.page { fill: #0d1117; } text { fill: #e6edf3; }
.state { fill: #21262d; stroke: #8d96a0; } .waits { fill: #10294a; stroke: #4493f8; }
.line { stroke: #8d96a0; } tspan.ours, text.ours { fill: #e3a35b; }
.head { fill: #8d96a0; } .quiet { fill: #9198a1; }
}
"""


def line(points, css, arrow=True):
    path = "M" + " L".join(f"{x},{y}" for x, y in points)
    return f'<path class="{css}" d="{path}"' + (' marker-end="url(#head)"/>' if arrow else "/>")


def words(rows, place):
    """One line for each row that goes this way; those of the manual first."""
    x, y, anchor = place
    parts = []
    for _, _, _, ours, text in sorted(rows, key=lambda row: row[3]):
        css = ' class="ours"' if ours else ""
        part = f"<tspan{css}>{html.escape(text)}</tspan>"
        if part not in parts:
            parts.append(part)
    # Of words on a line that goes across, the first stand over it
    under = 4 if any(abs(y + 5 - middle(s)) < 12 for s in PLACES) else 0
    return "\n".join(f'<text x="{x}" y="{y + i * 14 + (under if i else 0)}" '
                     f'text-anchor="{anchor}">{part}</text>' for i, part in enumerate(parts))


def box(state, number):
    x, y = PLACES[state][0], top(state)
    css = "state waits" if state.endswith("_WAIT") or state == "ALARM_DIR" else "state"
    return (f'<rect class="{css}" x="{x}" y="{y}" width="{BOX_W}" height="{BOX_H}" rx="6"/>\n'
            f'<text class="name" x="{x + BOX_W // 2}" y="{y + BOX_H // 2 + 4}" '
            f'text-anchor="middle">{number} {state}</text>')


def rails():
    """What leads back to ALARM_PROCESS."""
    into, lowest = gap("ALARM_PROCESS"), middle("SENSED")
    left = [(LEFT_RAIL, lowest), (LEFT_RAIL, middle("ALARM_PROCESS")),
            (LEFT, middle("ALARM_PROCESS"))]
    right = [(RIGHT_RAIL, lowest), (RIGHT_RAIL, into), (LEFT + 166, into),
             (LEFT + 166, bottom("ALARM_PROCESS"))]
    half = (top("ALARM_LATCH") + middle("ALARM_PROCESS")) // 2
    return [line(left, "line rail"), line(right, "line rail"),
            *(f'<text transform="translate({x},{half}) rotate(-90)" text-anchor="middle">next alarm'
              '</text>' for x in (LEFT_RAIL - 10, RIGHT_RAIL + 18))]


def draw(rows, numbers):
    known = ways()
    by_way = {}
    for row in rows:
        by_way.setdefault((row[0], row[2]), []).append(row)
    wrong = sorted(set(known) ^ set(by_way))
    if wrong:
        sys.exit("; ".join(f"{a} to {b}: " + ("in the table, not drawn" if (a, b) in by_way
                                              else "drawn, not in the table") for a, b in wrong))
    out = ['<svg xmlns="http://www.w3.org/2000/svg" '
           f'viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}">', "<!-- SPDX-License-Identifier: MIT -->",
           "<!-- Made of src/daemon/engine/alarm/alarm_fsm.c by docs/alarm-states.py: make diagrams -->",
           f"<style>{STYLE}</style>",
           '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" '
           'markerHeight="8" markerUnits="userSpaceOnUse" orient="auto">'
           '<path class="head" d="M0,0 L8,4 L0,8 z"/></marker></defs>',
           f'<rect class="page" width="{WIDTH}" height="{HEIGHT}" rx="8"/>', *rails()]
    labels = []
    for way, (points, place) in known.items():
        ours = all(row[3] for row in by_way[way])
        to_rail = way[1] == "ALARM_PROCESS" and points[-1][0] in (LEFT_RAIL, RIGHT_RAIL)
        out.append(line(points, "line ours" if ours else "line", not to_rail))
        labels.append(words(by_way[way], place))
    out += [box(state, numbers[state]) for state in PLACES] + labels
    y = HEIGHT - 30
    out += [f'<text class="quiet" x="{LEFT}" y="{y}">blue: waits for the bus</text>',
            f'<text class="ours" x="{LEFT + 160}" y="{y}">italic, dashed: a ruling of owsd, '
            'where the manual says nothing</text>', "</svg>"]
    return "\n".join(out) + "\n"


if __name__ == "__main__":
    table = sys.argv[1] if len(sys.argv) > 1 else TABLE
    sys.stdout.write(draw(read_table(table), read_numbers(table)))
