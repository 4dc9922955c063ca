#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The programs that the documentation's commands find in place of the real ones (test_docs.py).

owsd and owsctl are the real ones, with what a reader would have replaced: every target by a
simulated network, the instance by the test's own, ports by free ones, and what never ends by
something that does. What would change a machine, or needs hardware, is looked at only: it must be
one of the uses written down here. STAGE is the directory, NAME the instance, SERVED the port.
"""

import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = pathlib.Path(os.environ.get("OWSD_SOURCE", HERE.parents[1]))
BUILD = pathlib.Path(os.environ.get("OWSD_BUILD", SOURCE / "build"))
STAGE, NAME = pathlib.Path(os.environ.get("STAGE", ".")), os.environ.get("NAME", "")
SERVED = os.environ.get("SERVED", "")
SIMULATED = f"sim:{STAGE}/stage.sim"
HARDWARE = re.compile(r"^(i2c:(auto|/dev/i2c-\d(:0x[0-9a-f]{2}(\.\d)?)?)|w1(:.*)?|auto|gpio:.*)$")
OURS = set(re.findall(r"^Package: (\S+)$", (SOURCE / "board/debian/control").read_text(), re.M))
DEBIAN = {"owserver", "ow-shell", "mosquitto", "libgpiod-dev", "i2c-tools", "linuxcnc-uspace",
          "linuxcnc-uspace-dev", "msmtp-mta"} | OURS
FACES = [re.split(" *[|] *", line) for line in (SOURCE / "board/faces").read_text().splitlines()
         if not line.startswith("#")]
SOCKETED = "|".join(row[0] for row in FACES if row[-1] == "-")
OTHERS = "|".join(row[0] for row in FACES if row[-1] != "-")
UNIT = rf"(owsd(-firstboot|@\w+)?|({OTHERS})(@\w+)?|({SOCKETED})@\w+(\.socket|\.service)?|owserver(\.socket|\.service)?)"
GROUPS = "(i2c|gpio|owsd|owsd-control|owsd-config)"

# What may be said to programs that are not run: the whole of their arguments
LOOKED_AT = {
    "git": [r"tag -a v\d+\.\d+\.\d+ -m owsd \d+\.\d+\.\d+"],
    "systemctl": [rf"(status|start|stop|restart|reload|edit) {UNIT}( {UNIT})*",
                  rf"(enable|disable)( --now)? {UNIT}( {UNIT})*", "daemon-reload"],
    "journalctl": [rf"-u {UNIT}( -f| -e)?"],
    "systemd-analyze": [rf"security {UNIT}"],
    "adduser": [rf"[\w-]+ {GROUPS}"],
    "usermod": [rf"-aG {GROUPS} [\w-]+"],
    "raspi-config": ["", "nonint do_i2c 0"],
    "modprobe": ["i2c-dev", "ds2482", "w1-gpio", "w1_therm"],
    "udevadm": ["trigger", "control --reload"],
    "hostnamectl": [r"hostname pi-[0-9a-f]{8}"],
    "ansible-playbook": [r"-i inventory site\.yml( --check --diff| --limit \w+| -e owsd_state=latest)?"],
    "reboot": [""],
    "setpriv": ["--reuid owsd-notify --regid owsd --init-groups owsd-notify --test"],
    "ssh": [r"(-[nt] )?pi\d (sudo )?owsctl (list|watch|reload|--json stats)"],
    "i2cdetect": [r"-y \d"],
    "mbpoll": [r"-m tcp -0 -1 -t 4:float -B -r 46002 -c 3 192\.168\.1\.10"],
    "gpiodetect": [""], "gpioinfo": [""], "lsusb": [""],
    "halcompile": [r"--install --userspace --extra-link-args=-lows owsd_hal\.c"],
    "wget": [r"-O \S*/etc/apt/sources\.list\.d/owsd\.sources https://packages\.example\.org/owsd/\w+\.sources"],
    "gpg": [r"--quick-generate-key owsd packages <packages@example\.org> ed25519 sign 2y",
            r"--list-keys --with-colons packages@example\.org", "--show-keys", "--quick-set-expire OLD 2y"],
    "rsync": [r"-a( --exclude InRelease)? build/repository/ packages\.example\.org:/srv/www/owsd"],
    "g++": [r"-shared -fPIC -O2 -DOPENPLC_V4 -I openplc-runtime/core/src/drivers -o libowsd\.so owsd\.cpp -lows"],
    "skopeo": [r"copy oci:build/oci:VERSION-amd64 docker-daemon:localhost/owsd:latest"],
    "podman": [r"pull oci:build/oci:VERSION-arm64"],
    "docker": ["compose up -d", "compose restart owsd", "compose exec owsd owsctl scan --rio"],
    "getent": ["group i2c", "group owsd owsd-control"],
    "halrun": [r"-I owsd\.hal"],
    "rpi-image-gen": [r"build -S /path/to/owsd/board/image/rpi-image-gen -c owsd\.yaml"],
}


def fail(text):
    print(f"{pathlib.Path(sys.argv[0]).name}: {text}", file=sys.stderr)
    sys.exit(2)


def run(command):
    os.execv(command[0], [str(c) for c in command])


def place(argument):
    """A target of the documentation as one of the test."""
    if HARDWARE.match(argument):
        return SIMULATED
    return re.sub(r"^(localhost|127\.0\.0\.1):4304$", f"127.0.0.1:{SERVED}", argument)


def with_sim(program, arguments):
    """The wire of the stage is simulated. But what a page gives a simulated target says so itself."""
    said = any("sim:" in a for a in arguments)
    return BUILD / (pathlib.Path(sys.argv[0]).name if said else program + "-sim")


def owsctl(arguments):
    words = [place(a) for a in arguments]
    if "enable" in words:  # for root, of the machine: is there such a program?
        run([BUILD / "owsctl", "disable", "--dry-run", *words[words.index("enable") + 1:]])
    if "-n" in words:
        words[words.index("-n") + 1] = NAME
    elif not {"-t", "config", "--help", "-h", "--version", "-V"} & set(words[:3]) or \
            {"watch", "wait"} & set(words):
        words[:0] = ["-n", NAME]
    if "modbus-map" in words:
        (STAGE / "modbus").mkdir(exist_ok=True)
        (STAGE / "modbus/map").write_text("1 /28.000000000001/temperature\n")
        words += ["-d", STAGE / "modbus"]
    if "watch" in words:
        words += ["-c", "2", "-t", "1"]
    if "wait" in words and "-t" in words[words.index("wait"):]:
        last = len(words) - 1 - words[::-1].index("-t")
        words[last + 1] = str(min(60, int(words[last + 1])))
    run([with_sim("owsctl", arguments), *words])


def owsd(arguments):
    import owsdtest  # only here: the other programs are to start quickly
    words = [place(a) for a in arguments]
    program = with_sim("owsd", arguments)
    if any(w.startswith("--board") for w in words):
        run([program, *words, "--root", STAGE / "root"])
    for option in ("-n", "-l"):
        for at in (i + 1 for i, w in enumerate(words) if w == option):
            words[at] = NAME + "d" if option == "-n" else f"127.0.0.1:{owsdtest.free_port()}"
    if "-c" not in words and not {"-t", "-l"} <= set(words):
        words += ["-c", str(STAGE / "root/etc/owsd/OWS.rio")]
    if {"--check", "-V", "--version", "-h", "--help"} & set(words):
        run([program, *words])
    if "-t" not in words:
        words += ["-t", SIMULATED]
    if "-n" not in words:
        words += ["-n", NAME + "d"]
    sys.exit(until_ready([str(program), *words], owsdtest.PATIENCE))


def face(program):
    """It waits for an owsd that is not there."""
    def run(arguments):
        import owsdtest
        words = [place(a) for a in arguments]
        if "-n" not in words:
            words += ["-n", NAME + "r"]
        if "--check" in words:
            os.execv(BUILD / program, [program, *words])
        sys.exit(until_ready([str(BUILD / program), *words], owsdtest.PATIENCE))
    return run


def owsd_web(arguments):
    """It waits for an owsd that is not there."""
    import owsdtest
    words = [place(a) for a in arguments]
    for at in (i + 1 for i, w in enumerate(words) if w == "-l"):
        words[at] = f"127.0.0.1:{owsdtest.free_port()}"
    if "-c" not in words:
        words += ["-c", str(STAGE / "root/etc/owsd/OWS.rio")]
    if "-n" not in words:
        words += ["-n", NAME + "w"]
    sys.exit(until_ready([str(BUILD / "owsd-web"), *words], owsdtest.PATIENCE))


def until_ready(command, seconds):
    """Start owsd, wait until it says that it is ready, and end it."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as notify:
        address = str(STAGE / f"notify{os.getpid()}")
        notify.bind(address)
        daemon = subprocess.Popen(command, env=dict(os.environ, NOTIFY_SOCKET=address))
        said = b""
        deadline = time.monotonic() + seconds
        notify.settimeout(0.1)
        while b"READY=1" not in said and daemon.poll() is None and time.monotonic() < deadline:
            try:
                said = notify.recv(4096)
            except socket.timeout:
                pass
        daemon.send_signal(signal.SIGTERM)
        status = daemon.wait(seconds)
        return status if b"READY=1" in said else status or 1


def sudo(arguments):
    while arguments and re.match(r"\w+=", arguments[0]):
        arguments = arguments[1:]
    os.execvp(arguments[0], arguments)


def make(arguments):
    """Targets and variables have to be there; building is the business of other tests."""
    text = "\n".join(p.read_text() for p in [SOURCE / "Makefile", *SOURCE.glob("tests/*/*.mk")])
    known = set(" ".join(re.findall(r"^([\w/. -]+):(?!=)", text, re.M)).split())
    phony = re.search(r"^\.PHONY:((?:.*\\\n)*.*)$", text, re.M)[1]
    known |= set(phony.replace("\\", " ").split())
    for word in arguments:
        variable = re.match(r"(\w+)=", word)
        if variable and not re.search(rf"\$[({{]{variable[1]}[)}},]|^{variable[1]}\s*\??=", text, re.M):
            fail(f"no variable {variable[1]}")
        if not variable and not re.match(r"-[jks]\d*$", word) and word not in known:
            fail(f"no target {word}")


def apt(arguments):
    if arguments in (["update"], ["upgrade"], ["list", "-a", "owsd"]):
        return
    if arguments[:1] != ["install"] or len(arguments) < 2:
        fail("only install is known here")
    for word in arguments[1:]:
        package = re.match(r"(?:\./(?:build/deb/)?)?([a-z0-9-]+)(?:_\*\.deb|=VERSION)?$", word)
        if not package or package[1] not in DEBIAN:
            fail(f"no package {word}")


def one_wire_shell(program, arguments):
    """owdir, owread, owwrite: the genuine ones, at the port that the test serves; where they are
    not installed, owsctl speaks their protocol."""
    at = arguments.index("-s") if "-s" in arguments else None
    if at is not None:
        arguments = arguments[:at] + arguments[at + 2:]
    if not shutil.which(program, path="/usr/bin"):
        words = [a for a in arguments if not a.startswith("-")]
        run([BUILD / "owsctl", "-t", f"127.0.0.1:{SERVED}", program[2:], *words])
    run([f"/usr/bin/{program}", "-s", f"127.0.0.1:{SERVED}", *arguments])


def owfs_program(program, arguments):
    """owserver, owfs, owhttpd: not started, but their help has to know each option."""
    if not shutil.which(program, path="/usr/bin"):
        return
    said = "".join(subprocess.run([f"/usr/bin/{program}", f"--help={part}"], capture_output=True,
                                  text=True, check=False).stdout
                   for part in ("device", "cache", "program", "job", "temperature"))
    for option in (a.split("=")[0] for a in arguments if a.startswith("-")):
        if not re.search(rf"(?<![\w-]){option}(?!\w)", said):
            fail(f"no option {option}")


def pkg_config(arguments):
    if arguments == ["--variable=libdir", "libows"]:
        print(BUILD)
        return
    libraries = sorted(arguments)[2:]
    if sorted(arguments)[:2] != ["--cflags", "--libs"] or not libraries \
            or set(libraries) - {"libows", "libows-history"}:
        fail(f"not for libows: {arguments}")
    print(f"-I{SOURCE}/src/public -L{BUILD}",
          *(f"-l{library[3:]}" for library in libraries))


def compiler(name):
    """The machine's, with the sanitizers that libows was built with."""
    return lambda arguments: run([shutil.which(name, path="/usr/local/bin:/usr/bin:/bin"),
                                  *arguments, *os.environ.get("EXTRA_CFLAGS", "").split()])


def jq(arguments):
    """Is it JSON that comes?"""
    for line in sys.stdin:
        json.loads(line)


def man(arguments):
    for page in arguments:
        if page.isdigit() or (SOURCE / page).exists() or list((SOURCE / "docs").glob(page + ".?")):
            continue
        fail(f"no page {page}")


RUN = {"owsctl": owsctl, "owsctl-sim": owsctl, "owsd": owsd, "owsd-sim": owsd,
       **{row[0]: face(row[0]) for row in FACES}, "owsd-web": owsd_web, "sudo": sudo, "make": make, "apt": apt, "apt-get": apt,
       "pkg-config": pkg_config, "jq": jq, "man": man, "cc": compiler("gcc"), "c++": compiler("g++")}
SHELL = ["owdir", "owread", "owwrite"]
OWFS = ["owserver", "owfs", "owhttpd"]
PROGRAMS = [*RUN, *SHELL, *OWFS, *LOOKED_AT]


def main():
    program, arguments = pathlib.Path(sys.argv[0]).name, sys.argv[1:]
    if program in RUN:
        RUN[program](arguments)
    elif program in SHELL:
        one_wire_shell(program, arguments)
    elif program in OWFS:
        owfs_program(program, arguments)
    elif not any(re.fullmatch(use, " ".join(arguments)) for use in LOOKED_AT[program]):
        fail(f"a use that nobody has looked at: {' '.join(arguments)}")


if __name__ == "__main__":
    main()
