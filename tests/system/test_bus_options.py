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
    page = page[page.index(".SH BUS KEYS"):]
    page = page[:page.index(".SH ", 4)]
    keys = {}
    for text in page.split("\n.TP\n\\fB")[1:]:
        key, text = text.split("\\fR\n", 1)
        said = re.match(r"Of (.*?):", text)
        if key != "Target":
            assert said, f"owsd.rio(5) does not say of which targets {key} is"
            keys[key] = set(re.findall(r"\\fB(\w+)", said[1]))
    auto = re.search(r"target \\fBi2c:auto\\fR has (.*) only", page)
    for key in re.findall(r"\\fB(\w+)", auto[1]):
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
