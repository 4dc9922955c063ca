# SPDX-License-Identifier: MIT
"""The words of qualities and errors: one table, src/ground/signal/words_list.h, and its copies.

The page's script and docs/doctor.md have what they show of it between two marks. `make
format` writes them anew.
"""

import re
import textwrap

TABLE = "src/ground/signal/words_list.h"
SCRIPT = "src/faces/web/page/words.js"
PAGE = "docs/doctor.md"
PUBLIC = "src/public/ows.h"
MACROS = ("QUALITY", "ERROR", "ALARM")
HEALTHS = {"FAILURE": "failure", "CHECK": "check function", "OFF_SPEC": "off spec"}
STRINGS = r'"(?:[^"\\]|\\.)*"'


def rows(text, macro):
    """The arguments of each row, of which the first is a name and the others are texts."""
    for found in re.finditer(rf"^{macro}\((\w+(?:, \w+)?),((?:\s*{STRINGS},?)+)\)$", text, re.M):
        texts, joined = [], ""
        for piece, end in re.findall(rf"({STRINGS})(,|\s*)", found[2] + ","):
            joined += piece[1:-1].replace('\\"', '"')
            if end == ",":
                texts.append(joined)
                joined = ""
        yield found[1], *texts


def script_of(table, public):
    """The rows of the Map that words.js has."""
    out = []
    for names, *texts in rows(table, "QUALITY"):
        code = names.split(", ")[0]
        number = re.search(rf"\bOWS_Q_{code} = (0x\w+)", public)[1]
        lines = [f"\t[{number}, ["]
        for text in texts:
            text = re.sub(r'"([^"]*)"', "\\\\u201c\\1\\\\u201d", text).replace("'", "\\u2019")
            text = text.replace("\u00b0", "\\u00b0")
            pieces = textwrap.wrap(text, 84, break_on_hyphens=False)
            for i, piece in enumerate(pieces):
                blank = " " if i + 1 < len(pieces) else ""
                end = "," if not blank else ""
                lines.append("\t\t" + ("+ " if i else "") + f'"{piece}{blank}"{end}')
        lines[-1] = lines[-1].removesuffix(",") + "]],"
        out += [lines[0] + lines[1].strip(), *lines[2:]]
    return "\n".join(out) + "\n"


def page_of(table):
    """Tables: of qualities and of alarms with cause and remedy, of healths, of errors with the remedy."""
    def row(*cells):
        cells = (re.sub(r'"((?:owsctl|property)[^"]*)"', r"`\1`", cell) for cell in cells)
        return "| " + " | ".join(re.sub(r"(?<![`\w])owsctl [a-z]+", r"`\g<0>`", cell) for cell in cells) + " |"

    def head(*cells):
        return ["", row(*cells), "|---" * len(cells) + "|"]

    out = []
    for macro, first in (("QUALITY", "quality"), ("ALARM", "alarm of a device")):
        out += head(first, "why", "what to do")
        out += [row(f"`{word}`", cause, remedy) for _, word, cause, remedy in rows(table, macro)]
    out += head("error", "what to do")
    out += [row(f"`{word}`", remedy) for word, remedy in
            reversed({word: remedy for _, word, remedy in reversed(list(rows(table, "ERROR")))}.items())]
    out += ["", "The health of a device is the worst of its signals, in the words of NAMUR NE 107:"]
    out += head("health", "qualities")
    more = {"CHECK": "; what is simulated"}
    for health in dict.fromkeys(names.split(", ")[1] for names, *_ in rows(table, "QUALITY")):
        out.append(row(f"`{HEALTHS[health]}`", ", ".join(
            f"`{word}`" for names, word, *_ in rows(table, "QUALITY") if names.endswith(health)) + more.get(health, "")))
    out.append(row("`maintenance required`", "all are good, and of 1000 requests and more since owsd started one of "
                   "a hundred failed"))
    return "\n".join(out[1:]) + "\n"


def copies(texts):
    """file -> its text as it should be"""
    table = texts[TABLE]
    wanted = {SCRIPT: ("// from src/ground/signal/words_list.h\n", "// to here\n",
                       script_of(table, texts[PUBLIC])),
              PAGE: ("<!-- from src/ground/signal/words_list.h -->\n", "<!-- to here -->\n",
                     "\n" + page_of(table) + "\n")}
    for file, (begin, end, inner) in wanted.items():
        before, rest = texts[file].split(begin)
        yield file, before + begin + inner + end + rest.split(end, 1)[1]


def check_the_words_of_qualities_and_errors_are_those_of_the_table(tree):
    if TABLE not in tree.files:
        return
    texts = {file: tree.text(file) for file in (TABLE, SCRIPT, PAGE, PUBLIC)}
    count = sum(len(re.findall(rf"^{macro}\(", texts[TABLE], re.M)) for macro in MACROS)
    read = sum(len(list(rows(texts[TABLE], macro))) for macro in MACROS)
    if read != count:
        yield TABLE, 1, f"{count - read} rows have another form; see the head of the table"
        return
    for file, wanted in copies(texts):
        if wanted != texts[file]:
            line = next(n for n, pair in enumerate(zip(wanted.splitlines() + [""],
                                                       texts[file].splitlines() + [""]), 1)
                        if pair[0] != pair[1])
            yield file, line, f"its words are not those of {TABLE}; make format"


def mend(tree):
    if TABLE in tree.files:
        for file, wanted in copies({f: tree.text(f) for f in (TABLE, SCRIPT, PAGE, PUBLIC)}):
            if wanted != tree.text(file):
                (tree.top / file).write_text(wanted)
