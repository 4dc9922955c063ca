#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""In a Debian that its own systemd has booted (pages): each shell block of PAGES, and each `sudo apt
install` within their text, in their order, is done by the user pi, who logs in anew for each. A line
that OTHERWISE names is done in another way, or not at all, and then counts as skipped."""

import os
import pathlib
import re
import subprocess
import sys

import handbook

PAGES = "bring-up install mqtt web history consumers fleet".split()
SOURCE = pathlib.Path("/home/pi/owsd")
# A command without its remark; what is done for it, or None; why
OTHERWISE = [
    (r"sudo raspi-config .*", None, "there is no Raspberry Pi"),
    (r"(echo dtparam=\S+ \| sudo tee -a) .*", r"\1 config.txt", "there is no Raspberry Pi"),
    (r"sudo reboot", None, "the test would end; suite deb reboots"),
    (r"make deb.*", None, "suite deb does; what it makes is in build/deb"),
    (r"owsd --board", None, "there is no Raspberry Pi; test_docs.py has one of files"),
    (r"(owsctl) -t (?:auto|w1) (scan.*)", r"\1 -t localhost:4304 \2", "a simulated house is no hardware"),
    (r"owsctl get (\w+)", r"owsctl wait \1 '>' -55 -t 60 >/dev/null; \g<0>", "a person is slower"),
    (r".*owsctl watch", r"\g<0> -c 2 -t 1", "nobody presses Ctrl-C"),
    (r"sudo tee /etc/credstore/\S+", r"echo secret | \g<0>", "nobody types"),
    (r"owsd-web -l (\S+)", r"\g<0> & curl -s -S -f --retry 20 --retry-connrefused http://\1/ >/dev/null; kill $!; wait $!",
     "nobody presses Ctrl-C"),
    (r"\./build/owsd-sim .*",
     r"\g<0> >sim.log 2>&1 & for i in $(seq 100); do owsctl get living >/dev/null 2>&1 && break; sleep 0.2; done",
     "it has a terminal of its own, and a person is slower"),
    (r"(serial=.*<)/sys/\S+( .*)", r"\1serial-number\2", "there is no Raspberry Pi"),
    (r"ansible-playbook .*", None, "test_fleet.py has Ansible do it"),
]
# A machine with a user, as its image has them, a house instead of an adapter, and files that pages
# take for granted: another instance, other machines
SETUP = r"""
useradd -m -s /bin/bash -G sudo,adm pi
for user in plc anna; do useradd -m $user; done
echo '%sudo ALL=(ALL) NOPASSWD: ALL' >/etc/sudoers.d/pi
echo 'PATH="$PATH:/usr/local/sbin:/usr/sbin"' >>/home/pi/.profile
echo 'APT::Get::Assume-Yes "true";' >/etc/apt/apt.conf.d/99pi
mv /root/test/owsd /home/pi
printf '10000000abcd1234\0' >/home/pi/owsd/serial-number
echo '127.0.1.1 pi7 pi8 pi9' >>/etc/hosts
chown -R pi: /home/pi
runuser -l pi -c 'mkdir -m 700 .ssh; ssh-keygen -q -N "" -f .ssh/id_rsa; cp .ssh/id_rsa.pub .ssh/authorized_keys
    echo "StrictHostKeyChecking accept-new" >.ssh/config'
runuser -l pi -c 'sudo apt install owsd owsd-sim'
mkdir /run/house
OWS_DIR=/run/house systemd-run -q -E OWS_DIR owsd-sim -n HOUSE -t sim:/root/test/house.sim -l 127.0.0.1:4304
echo 'OwsDrv { TargetName "localhost:4304" }' >/etc/owsd/HOUSE.rio
"""
used = set()


def run(script, *command):
    """Its exit status, 124 if it does not end, and what it said."""
    pathlib.Path("/tmp/script").write_text(script)
    ran = subprocess.run(["timeout", "-k", "5", "300", *command], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    return ran.returncode, ran.stdout, ran.stderr


def here(where, line):
    """A line of a page as it is done here; None: not at all."""
    command = re.sub(r"\s+# .*", "", line)
    for number, (pattern, instead, why) in enumerate(OTHERWISE):
        match = re.fullmatch(pattern, command)
        if match:
            used.add(number)
            if instead is None:
                print(f"skip - {where}: {command}: {why}")
                return None
            return match.expand(instead)
    return line


def steps(page):
    """What is to be done, as the page goes."""
    installs = [handbook.Block(page.name, line, "sh", code, None) for line, code in handbook.inline(page)
                if code.startswith("sudo apt install ")]
    return sorted(handbook.blocks(page) + installs, key=lambda block: block.line)


def do(block):
    where = f"{block.page}:{block.line}"
    if block.file and "/" not in block.file:
        (SOURCE / block.file).write_text(block.text)
    if block.language not in ("sh", "console"):
        return
    for text, expected in handbook.console(block.text) if block.language == "console" else [(block.text, "")]:
        lines = list(filter(None, (here(where, line) for line in text.splitlines())))
        if lines:
            status, said, traced = run("\n".join(lines) + "\n", "runuser", "-l", "pi", "-c", "cd owsd && bash -ex /tmp/script")
            if status == 0 and handbook.like(expected, said):
                print(f"ok - {where}")
            else:
                print(f"not ok - {where}: status {status}", traced, said, expected, sep="\n")


def main():
    status, said, traced = run(SETUP, "sh", "-ex", "/tmp/script")
    if status:
        print(f"not ok - owsd is installed from the repository: status {status}\n{traced}{said}")
        return
    with subprocess.Popen(["runuser", "-l", "pi", "-c", "sleep infinity"]) as terminal:
        for page in PAGES:
            subprocess.run(["systemctl", "start", "owsd@OWS"], check=False)
            for block in steps(SOURCE / f"docs/{page}.md"):
                do(block)
            status, said, traced = run("systemctl list-units --failed --no-legend --plain 'owsd*'\npkill -u pi -x owsd-sim || true\n",
                                       "sh", "/tmp/script")
            print(f"not ok - {page}.md: has failed: {said}{traced}" if status or said else f"ok - {page}.md: no unit has failed")
        terminal.kill()
    for number, (pattern, _, _) in enumerate(OTHERWISE):
        if number not in used:
            print(f"not ok - no page has {pattern} any more: take it out of as_pi.py")
    print("# the end")


if __name__ == "__main__":
    with open("/root/test/lines", "a", encoding="utf-8", buffering=1) as out:
        sys.stdout = out
        main()
    os.system("systemctl poweroff")
