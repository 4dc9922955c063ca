# SPDX-License-Identifier: MIT
"""The lists of owsd-signals(7) that tables in the code make: the qualities, with their numbers, and
the counters, each with the comment beside its name. `make format` writes them anew.
"""

import re
import textwrap

import words

PAGE = "docs/owsd-signals.7"
# Where the names of a list stand, what goes before each of them, and where the comments are
LISTS = (
    ("Of owsd", "", "src/daemon/engine/state.h", "ENGINE_COUNTERS"),
    ("Of owsd", "", "src/daemon/host/engine_thread.c", "host_counters"),
    ("Of the connections of programs", "control_", "src/memory/control/private.h", "CONTROL_COUNTERS"),
    ("Of the served protocol", "served_", "src/daemon/serve/server.h", "SERVE_COUNTERS"),
    ("Of each target", "", "src/daemon/engine/state.h", "LANE_COUNTERS"),
    ("Of a target whose wires owsd drives", "bus_", "hal/native/state.h", "NATIVE_WIRE_COUNTS"),
    ("Of a target whose wires owsd drives", "bus_", "hal/native/state.h", "NATIVE_COUNTS"),
    ("Of an owserver", "bus_", "hal/owserver/owserver.c", "counter_names"),
    ("Of GPIO lines", "bus_", "hal/gpio/gpio.c", "names"),
)
COMMENTS = {"hal/owserver/owserver.c": "hal/owserver/talk.h", "hal/gpio/gpio.c": "hal/gpio/lines.h"}
SOURCES = sorted({file for _, _, file, _ in LISTS} | set(COMMENTS.values()))
MARKS = {"qualities": '.\\" from src/ground/signal/words_list.h\n', "counters": '.\\" from the lists of counters\n'}
END = '.\\" to here\n'
COLUMN = 26  # where the words of a counter begin


def counters(texts, file, name):
    """(name, its comment or "") of each row of a macro of X(), or of an array of names."""
    text = texts[file]
    macro = re.search(rf"^#define {name}\(X(?:, n)?\) \\\n((?:.*\\\n)*.*\n)", text, re.M)
    if macro:
        for row in re.finditer(r'\bX\((\w+(?:##\w+)*)(?:,\s*(?:\\\s*)?((?:"\w+"|#n| )+))?\)\s*(?:/\* (.*?) \*/)?', macro[1]):
            yield re.sub(r'[" ]', "", row[2] or row[1]).replace("#n", "N"), row[3] or ""
        return
    array = re.search(rf"\*const {name}\[\w+\] = \{{(.*?)\}};", text, re.S)[1]
    for constant, word in re.findall(r'\[(\w+)\] = "(\w+)"', array):
        said = re.search(rf"^\t{constant}\b[^\n/]*/\* (.*?) \*/", text + texts.get(COMMENTS.get(file), ""), re.M)
        yield word, said[1] if said else ""


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("\u00b0", "\\[de]").replace("'", "\\(aq")
    return re.sub(r'"([^"]*)"', r"\\(lq\1\\(rq", text)


def row(word, said):
    """Two columns, which fit into 80 with the indent of a page."""
    lines = "\n".join(textwrap.wrap(said, 73 - COLUMN, break_on_hyphens=False))
    return f"\\fB{word}\\fR{' ' * (COLUMN - len(word))}" + roff(lines).replace("\n", "\n" + " " * COLUMN) + "\n"


def qualities(texts):
    found = [("good", 0xC0)]
    for names, word, *_ in words.rows(texts[words.TABLE], "QUALITY"):
        code = re.search(rf"\bOWS_Q_{names.split(', ')[0]} = (0x\w+)", texts[words.PUBLIC])[1]
        found.append((word, int(code, 16)))
    return ".PP\n.nf\n" + "".join(row(word, f"0x{number:02X}  {number}") for word, number in found) + ".fi\n"


def lists(texts):
    groups = {}
    for title, before, file, name in LISTS:
        groups.setdefault(title, []).extend((before + word, said) for word, said in counters(texts, file, name))
    return "".join(f".PP\n{title}:\n.PP\n.nf\n" + "".join(row(word, said) for word, said in sorted(rows)) + ".fi\n"
                   for title, rows in groups.items())


def page(texts):
    text = texts[PAGE]
    for what, mark in MARKS.items():
        before, rest = text.split(mark)
        text = before + mark + (qualities if what == "qualities" else lists)(texts) + END + rest.split(END, 1)[1]
    return text


def texts_of(tree):
    return {file: tree.text(file) for file in (PAGE, words.TABLE, words.PUBLIC, *SOURCES)}


def check_each_counter_has_its_words_in_the_page_of_signals(tree):
    if PAGE not in tree.files:
        return
    texts = texts_of(tree)
    for _, _, file, name in LISTS:
        found = list(counters(texts, file, name))
        if not found:
            yield file, 1, f"no counters are found in {name}"
        for word, said in found:
            if not said:
                yield file, 1, f"the counter {word} has no comment beside its name: say what it counts"
    if page(texts) != texts[PAGE]:
        yield PAGE, 1, "its lists are not those of the code; make format"


def mend(tree):
    if PAGE in tree.files:
        (tree.top / PAGE).write_text(page(texts_of(tree)))
