#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The options of a Bus block: each kind of target takes those that owsd.rio(5) says, and no others."""

import re

import owsdtest
from owsdtest import SOURCE

TARGETS = {"i2c": ["i2c:/dev/i2c-1"], "i2c:auto": ["i2c:auto"], "w1": ["w1", "w1:netlink"], "sim": ["sim:{sim}"],
           "gpio": ["gpio:gpiochip0"], "owserver": ["localhost:4304"], "null": ["null:"]}
VALUES = {"PowerLine": "gpiochip0/5", "SleepLine": "gpiochip0/6", "PowerOffMs": "500", "Sensors": "{sensors}",
          "ActiveLow": "5", "PullUp": "5", "PullDown": "5", "OpenDrain": "5", "OpenSource": "5", "Touch": "on"}
ITEM = dict(Name="x", Path="/28.000000000001/temperature", Type="double")


def documented():
    """Which kinds of target take each key, as the page says."""
    page = (SOURCE / "docs/owsd.rio.5").read_text()
    page = page[page.index(".Sh BUS KEYS"):]
    page = page[:page.index(".Sh ", 4)]
    keys = {}
    for text in page.split("\n.It Cm ")[1:]:
        key, text = text.split("\n", 1)
        said = re.search(r"^Of\n((?:\.Ql .*\n|and\n)+)", text, re.M)
        if key != "Target":
            assert said, f"owsd.rio(5) does not say of which targets {key} is"
            keys[key] = set(re.findall(r"\w+", re.sub(r"\.Ql|and\n", "", said[1])))
    auto = re.search(r"^\.Ql i2c:auto\nhas\n((?:\.Cm .*\n|and\n)+)only", page, re.M)
    for key in re.findall(r"\.Cm (\w+)", auto[1]):
        assert "i2c" in keys[key]
        keys[key].add("i2c:auto")
    return keys


def test_each_target_takes_its_options_and_no_others(scene):
    keys = documented()
    assert set(keys) == set(VALUES), keys
    assert set().union(*keys.values()) <= set(TARGETS), keys
    files = {"sim": scene.file("net.sim", "chip DS2482-100 0x18\n"),
             "sensors": scene.file("sensors.table", (SOURCE / "docs/examples/sensors.table").read_text())}
    for scheme, targets in TARGETS.items():
        for target in (target.format(**files) for target in targets):
            for key, kinds in keys.items():
                bus = f'  Bus {{ Target "{target}" {key} "{VALUES[key].format(**files)}" }}\n'
                text = owsdtest.rio(target, [ITEM]).replace("  Item {", bus + "  Item {", 1)
                done = scene.owsd_once("--check", "-c", scene.file("bus.rio", text))
                if scheme in kinds:
                    assert done.returncode == 0 and not owsdtest.but_of_here(done.stderr), (target, key, done)
                else:
                    assert done.returncode == 2, (target, key, done)
                    assert f"has no option {key}" in done.stderr, (target, key, done.stderr)


if __name__ == "__main__":
    owsdtest.main()
