# SPDX-License-Identifier: MIT
"""A small writer of line plots as SVG, legible on white and on black.

    plot(file, title, x_axis, y_axis, [Series("owsd", [(1, 0.8), (2, 0.9)])])

An axis is Axis(label, least, most, log, ticks); a tick is (value, text). The legend stands at the
right, in the order given. Dashed is for what is no measurement of ours: a limit, a peer's.
"""

import collections
import html
import math

WIDTH, HEIGHT = 760, 380
LEFT, RIGHT, TOP, BOTTOM = 64, 236, 44, 52
# On white, on black
COLOURS = [("#0060a8", "#5ab4f0"), ("#c04a00", "#ff9050"), ("#00805a", "#3fd0a0"),
           ("#a03c80", "#f090c8"), ("#806000", "#e0b840"), ("#505050", "#b0b0b0")]

Axis = collections.namedtuple("Axis", "label least most log ticks")
Series = collections.namedtuple("Series", "label points dashed marks", defaults=(False, True))


def style():
    light = "".join(f".c{i}{{stroke:{c[0]};fill:{c[0]}}}" for i, c in enumerate(COLOURS))
    dark = "".join(f".c{i}{{stroke:{c[1]};fill:{c[1]}}}" for i, c in enumerate(COLOURS))
    return (f"text{{fill:#222}}.bg{{fill:#fff}}.grid{{stroke:#ddd}}.axis{{stroke:#666}}{light}"
            "polyline{fill:none!important}"
            "@media(prefers-color-scheme:dark){text{fill:#ddd}.bg{fill:#10141a}.grid{stroke:#333a44}"
            f".axis{{stroke:#999}}{dark}}}")


def place(axis, value):
    """0 to 1 along the axis."""
    if axis.log:
        value, least, most = (math.log10(max(v, 1e-12)) for v in (value, axis.least, axis.most))
    else:
        least, most = axis.least, axis.most
    return min(1.0, max(0.0, (value - least) / (most - least)))


def plot(file, title, x_axis, y_axis, series):
    def x(value):
        return LEFT + place(x_axis, value) * (WIDTH - LEFT - RIGHT)

    def y(value):
        return HEIGHT - BOTTOM - place(y_axis, value) * (HEIGHT - TOP - BOTTOM)

    def text(at_x, at_y, words, anchor="start", more=""):
        out.append(f'<text x="{at_x:.0f}" y="{at_y:.0f}" text-anchor="{anchor}"{more}>'
                   f'{html.escape(words)}</text>')

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           f'width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="12" role="img">',
           "<!-- SPDX-License-Identifier: MIT -->", f"<title>{html.escape(title)}</title>",
           f"<style>{style()}</style>", '<rect class="bg" width="100%" height="100%"/>']
    text(LEFT, 24, title, more=' font-size="15"')
    for value, words in x_axis.ticks:
        out.append(f'<path class="grid" d="M{x(value):.1f} {TOP}V{HEIGHT - BOTTOM}"/>')
        text(x(value), HEIGHT - BOTTOM + 16, words, "middle")
    for value, words in y_axis.ticks:
        out.append(f'<path class="grid" d="M{LEFT} {y(value):.1f}H{WIDTH - RIGHT}"/>')
        text(LEFT - 6, y(value) + 4, words, "end")
    out.append(f'<path class="axis" fill="none" d="M{LEFT} {TOP}V{HEIGHT - BOTTOM}H{WIDTH - RIGHT}"/>')
    text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 14, x_axis.label, "middle")
    text(0, 0, y_axis.label, "middle",
         f' transform="translate(16 {(TOP + HEIGHT - BOTTOM) / 2:.0f}) rotate(-90)"')
    for i, one in enumerate(series):
        colour = f"c{i % len(COLOURS)}"
        dash = ' stroke-dasharray="6 4"' if one.dashed else ""
        points = " ".join(f"{x(a):.1f},{y(b):.1f}" for a, b in one.points)
        out.append(f'<polyline class="{colour}" stroke-width="2"{dash} points="{points}"/>')
        if one.marks and not one.dashed:
            out += [f'<circle class="{colour}" cx="{x(a):.1f}" cy="{y(b):.1f}" r="3"/>'
                    for a, b in one.points]
        at = TOP + 10 + 34 * i
        out.append(f'<path class="{colour}" fill="none" stroke-width="2"{dash} '
                   f'd="M{WIDTH - RIGHT + 14} {at}h26"/>')
        first, _, second = one.label.partition("\n")
        text(WIDTH - RIGHT + 46, at + 4, first)
        text(WIDTH - RIGHT + 46, at + 18, second, more=' font-size="10"')
    out.append("</svg>\n")
    with open(file, "w", encoding="utf-8") as f:
        f.write("\n".join(out))
