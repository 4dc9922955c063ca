# SPDX-License-Identifier: MIT
"""Markdown pages as text: tables, items, and how often a reader has to look back for what
a word stands for."""

import re

# In 1000 words of prose: words that stand for others, and semicolons
MOST = 100, 16
# Pages that have more. These numbers only fall; who rewrites a page takes its row out
MORE = {"docs/bridges.md": (109, 16), "docs/doctor.md": (100, 19), "docs/first-face.md": (108, 16),
        "docs/history.md": (116, 16), "docs/install.md": (104, 16), "docs/mqtt.md": (111, 16),
        "docs/repository.md": (120, 16), "docs/troubleshooting.md": (100, 21), "NEWS.md": (100, 20)}
MADE = {"docs/properties.md"}  # by a program, of data with a grammar of their own
FEW = 200  # words: a page with fewer says nothing of its style
STAND_INS = set("that those this these which it its who whom what one ones they them their such so there "
                "then else here".split())


def pages(tree):
    return [f for f in tree.ending(".md") if "/" not in f or f.startswith("docs/")]


def prose(text):
    """(number, line) of what is neither code nor made by a program."""
    code = made = False
    for n, line in enumerate(text.split("\n"), 1):
        if line.lstrip().startswith("```"):
            code = not code
        elif line.startswith("<!-- "):
            made = line.startswith("<!-- figures")
        elif not code and not made:
            yield n, line


def check_each_row_of_a_page_belongs_to_a_table(tree):
    """Another renders as a paragraph of bars."""
    for file in pages(tree):
        lines = tree.text(file).split("\n") + [""]
        for n, line in prose(tree.text(file)):
            if line.startswith("|") and not lines[n - 2].startswith("|") and not re.fullmatch(r"\|[-:| ]+", lines[n]):
                yield file, n, "a row without a table; put the head or the rows before it there"


def check_no_item_of_a_page_is_empty(tree):
    for file in pages(tree):
        for n, line in prose(tree.text(file)):
            if re.fullmatch(r" *[-*] *", line):
                yield file, n, "an empty item; make a table of the list"


def style(text):
    """Words of the prose, and of 1000 how many stand for others, and how many semicolons there are."""
    text = "\n".join(line for _, line in prose(text) if not line.startswith(("|", "#", "!")))
    text = re.sub(r"\]\([^)]*\)", "", re.sub(r"`[^`]*`", "X", text))
    words = [w.lower().strip(".'") for w in re.findall(r"[A-Za-z0-9'.-]+", text)]
    many = max(len(words), 1) / 1000
    return len(words), sum(w in STAND_INS for w in words) / many, text.count(";") / many


def check_no_page_has_more_stand_ins_or_half_sentences_than_it_may(tree):
    for file in pages(tree):
        words, stand_ins, halves = style(tree.text(file))
        if words < FEW or file in MADE:
            continue
        for of, most, what in ((stand_ins, 0, "words as that, it, which, one: write the noun"),
                               (halves, 1, "semicolons: make sentences of both halves")):
            limit = MORE.get(file, MOST)[most]
            if of > limit:
                yield file, 1, f"{of:.0f} of 1000 words are {what}; {limit} may be"
