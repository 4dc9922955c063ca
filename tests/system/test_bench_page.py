#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""tests/bench/page: figures that were saved become tables and plots, and the prose stays."""

import json
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET

import owsdtest
from owsdtest import SOURCE

PAGE = SOURCE / "docs/performance.md"
POINTS = (0, 1, 10, 25, 50, 75, 90, 99, 100)


def some_output():
    """What the benches print, with made-up figures."""
    lines = ["# a note", "shm_get 9.00 ns", "set_to_wire 142 us", "owserver_reads 17400 reads/s",
             "owserver_reads.cpu 10.40 us/read", "owserver_reads.bare_socket 18000 reads/s",
             "owserver_reads.bare_socket.cpu 9.60 us/read", "rss 3024 KiB", "rss.owserver 5152 KiB",
             "text_size 535 KiB", "cpu_idle 0.57 %", "cpu_idle.owserver 0.46 %", "cpu_idle.bare_socket 0.21 %",
             "cpu_idle.no_signals 0.02 %", "cpu_idle.one_cpu 0.10 %", "wakes.no_signals 3.10 /s", "rss.proportional 1402 KiB",
             "rss.anonymous 504 KiB", "history.file 197 MB", "history.year_of_one.p50 13.00 ms",
             "history.day_of_ten.p50 11.00 ms", "recorder.50.rrdtool.file 7.58 MB", "recorder.10000.rrdtool.file 1516 MB",
             "limit.cache 1.40 ns",
             "limit.memory 120 ns", "limit.wake 30.00 us", "shm_get.owserver_read 70000 ns",
             "limit.loopback.pinned 73000 1/s", "limit.loopback.apart 20000 1/s",
             "limit.loopback.pinned.new 30000 1/s", "limit.loopback.pinned.16 90000 1/s", "limit.loopback.pinned.64 90000 1/s",
             "served_rss.64_clients 3432 KiB", "served_rss.64_clients.owserver 6564 KiB",
             "served_late_periods 0.00 periods", "served_periods 900 periods",
             "set_to_wire.wakes 100.00 us", "set_to_wire.wakes_loopback 120.00 us"]
    lines += [f"{scheme}.{what}{who} 1.50 s" for scheme in ("serial", "uart") for who in ("", ".owserver")
              for what in ("scan.10", "scan.50", "scan.50.trips", "cpu.20", "cpu.20.readings")]
    lines += ["page.idle.rss 4400 KiB", "page.idle.rss.own 700 KiB",
              "page.paint.first 90 ms", "page.paint.paint 150 ms",
              "page.paint.again 210 ms", "page.streams.0.cpu 0.20 %", "page.streams.0.rss 26000 KiB"]
    for name in ("streams.1", "streams.100", "quiet.100"):
        lines += [f"page.{name}.cpu 1.50 %", f"page.{name}.rss 26112 KiB", f"page.{name}.bytes 45.00 kB/s"]
    for name in ("streams.1.age", "streams.100.age", "quiet.100.age", "screen", "screen.quiet"):
        lines += [f"page.{name}.p{p} {p + (30 if name == 'screen' else 0)} ms" for p in (50, 95, 99)]
    lines.append("page.owhttpd.cached.p50 4.50 ms")
    for at in (f"recorder.{n}.{who}" for n in (50, 10000)
               for who in ("owsd", "sqlite", "rrdtool")):
        lines += [f"{at}.written_a_day 121 MB", f"{at}.growth_a_day 22.02 MB", f"{at}.cpu 22.25 us/s",
                  f"{at}.memory 4336 kB"]
    for n in (10, 1000, 10000):
        lines += [f"changes.{n} 500.00 ns", f"changes.scan.{n} {15 * n} ns"]
    lines += [f"engine_step.{n} {n / 10 + 300:.0f} ns" for n in (10, 100, 1000, 10000)]
    lines += [f"engine_step.{n} 400 ns" for n in ("targets.8", "targets.16", "targets.64", "quiet.10",
                                                  "quiet.10000", "quiet.targets.16", "quiet.targets.64")]
    for of in ("signals.10", "signals.100", "signals.1000", "signals.10000", "targets.8", "targets.16",
               "targets.64", "consumers.1", "consumers.100"):
        lines += [f"growth.{of}.{what} 8.00 ms" for what in ("start", "reload", "memory", "reading", "wakes",
                                                             "quiet", "quiet_wakes")]
    for name in ("shm_get.single", "shm_get.clock", "shm_get.owserver_read", "set_to_wire",
                 "input_latency.alarm4", "input_latency.alarm10", "input_latency.cyclic"):
        lines += [f"{name}.p{p} {10 + p:.2f} ns" for p in POINTS]
    lines += [f"scan.{n}.400kHz.first 1.25 s" for n in (1, 10, 50, "80on8")]
    for net in (1, 2, 5, 10, 20, 50, 100, "80on8", "80on4chips", "80on8chips"):
        for case in ("400kHz", "400kHz.one-read", "100kHz", "100kHz.one-read"):
            lines += [f"scan.{net}.{case}.seconds 1.20 s", f"scan.{net}.{case}.over_limit 1.05 ratio",
                      f"scan.{net}.{case}.steady 0.90 s"]
    lines += [f"scan.{n}.400kHz.quick.{what} 0.80 s" for n in (1, 2, 5, 10, 20, 50)
              for what in ("seconds", "steady")]
    for where in ("pinned", "apart"):
        for n in ("new", 1, 16, 64):
            for who in ("", ".owserver"):
                lines += [f"served_reads.{where}.{n}{who} {1000 if who else 4000} 1/s",
                          f"served_p50.{where}.{n}{who} 50.00 us", f"served_p99.{where}.{n}{who} 99.00 us"]
    return "\n".join(lines)


def some_rig():
    rows = [f"# | {way:54} | {n:7} | {1 + n / 10:6.2f} | {n * 60:12} | {n * 200:9} | {n * 12:7} | {n:6} |"
            for way in ("owsd direct, the first scan of all", "owsd direct",
                        "owserver, /simultaneous, 0.8 s, /uncached latesttemp",
                        "kernel w1, therm_bulk_read, then each temperature", "kernel w1, one by one")
            for n in (1, 2, 5, 10, 20, 50)]
    for who in ("owsd", "owserver"):
        rows += [f"# | {f'devices, {who}: {what}':54} |      85 |   4.00 |         2000 |     10000 |    1000 |     90 |"
                 for what in ("scan", "list", "read")]
    return "\n".join(["ok - something", "# | way | sensors |", *rows, "6 passed, 0 failed"])


def saved(scene, load=0.1, kernel=True):
    """A copy of the page and what it is written from."""
    figures = scene.path / "bench-page"
    figures.mkdir()
    (figures / "made_up.1.txt").write_text(some_output())
    if kernel:
        (figures / "kernel.txt").write_text(some_rig())
    (figures / "machine.json").write_text(json.dumps({
        "commit": "abc1234", "cpu": "Some CPU", "cores": 2, "virtual": True, "kernel": "6.1",
        "compiler": ["gcc 12"], "owserver": "3.2", "load": load, "runs": 3}))
    (scene.path / "docs/img").mkdir(parents=True)
    return shutil.copy(PAGE, scene.path / "docs/performance.md")


def written(scene, page):
    done = subprocess.run([sys.executable, SOURCE / "tests/bench/page", "--saved", "--build", scene.path,
                           "--page", page, "--data", scene.path / "figures.tsv"], capture_output=True, text=True, timeout=owsdtest.PATIENCE)
    return done.returncode, done.stdout + done.stderr, page.read_text()


def prose(text):
    """What stands outside the marks, which nobody but a writer changes."""
    kept, inside = [], False
    for line in text.splitlines():
        inside = inside and line != "<!-- end of figures -->"
        if not inside:
            kept.append(line)
        inside = inside or line.startswith("<!-- figures ")
    return kept


def test_saved_figures_become_tables_and_the_prose_is_kept(scene):
    page = saved(scene)
    before = page.read_text()
    status, said, after = written(scene, page)
    assert status == 0, said
    assert prose(after) == prose(before)
    assert "Commit abc1234; Some CPU (virtual machine), 2 cores" in after
    assert "| `rss`: resident with 100 signals | 3 024 KiB | owserver 5 152 KiB | 2.6 MiB: **missed** |" in after
    assert "10 ns, or three loads from that cache: met" in after
    assert "| 1 000, 64 targets | 8.0 ms | 8.0 ms | 8.0 KiB | 8.0 us | 8.0 % | 400 ns |" in after
    assert "| 1 000, 100 programs | 8.0 ms | 8.0 ms | 8.0 KiB | 8.0 us | 8.0 % |  |" in after
    assert "| 50 | 1.20 s | 1.05 | 1.20 s | 0.90 s | 0.80 s | 1.25 s | 1.7 s: met |" in after
    assert "| 80 on 8 channels | 1.20 s | 1.05 | 1.20 s | 0.90 s |  | 1.25 s | 2.2 s: met |" in after
    assert "| alarm items, idle search 10 % | 60 ms | 109 ms | 70 ms: **missed** |" in after
    assert "| 50 | rrdtool, the archives of collectd | 121 MB | none, 7.6 MB | 22.2 us/s | 4 336 kB |" in after
    assert "1.3 times that over loopback" in after
    assert "| 1, pinned | 4 000/s | 50.0, 99.0 us | 1 000/s | 4.0 | 73 000/s | 1.2 times the time of loopback alone: **missed** |" in after
    assert "| 16, pinned | 4 000/s | 50.0, 99.0 us | 1 000/s | 4.0 | 90 000/s | 8 times: **missed** |" in after
    assert "| all of 50 thermometers anew, 100 kHz, kernel rig | 6.0 s | kernel w1 6.0 s (bulk), 6.0 s (one by one), owserver 6.0 s |" in after
    assert "| served reads, 1 client | 4 000/s | owserver 1 000/s |" in after
    assert "| owsd direct | 6.00 | 3000 | 600 |" in after
    assert "| resident with 100 signals, nobody looks | 4 400 KiB | 5 MB: met |" in after
    assert "have values | 150 ms | 200 ms: met |" in after
    assert "| 100, 15 % | 1.50 % | 25.5 MiB | 45.0 kB/s | 50.0, 95.0, 99.0 ms |" in after
    assert "| 15 % change each second | 80.0, 125, 129 ms | p95 100 ms and a frame: **missed** |" in after
    assert "| one signal changes | 50.0, 95.0, 99.0 ms | p95 100 ms and a frame: met |" in after
    assert "not quiet" not in after
    # whatever is missed in a table is in the list at the beginning
    short = after[after.index("| missed | measured | aim |"):after.index("<!-- end of figures -->", after.index("| missed |"))]
    assert short.count("\n| ") == after.count(": **missed** |") > 5
    assert "| served reads, clients: 16, pinned | 4.0 times | 8 times |" in short
    data = (scene.path / "figures.tsv").read_text()
    assert "rss\t3024\t3024\t3024\tKiB\n" in data and "owsd direct\t20\t3.00\t1200\t4000\t240\t20\n" in data
    again, _, same = written(scene, page)
    assert again == 0 and same == after


def test_plots_are_small_and_are_for_light_and_dark(scene):
    status, said, _ = written(scene, saved(scene))
    assert status == 0, said
    files = sorted((scene.path / "docs/img").glob("*.svg"))
    assert [f.name for f in files] == ["change.svg", "growth-users.svg", "growth.svg", "latency.svg",
                                       "scan.svg"]
    for file in files:
        assert file.stat().st_size < 60000, file
        root = ET.parse(file).getroot()
        lines = root.findall(".//{http://www.w3.org/2000/svg}polyline")
        assert 3 <= len(lines) <= 6, f"{file.name}: {len(lines)} lines"
        for line in lines:
            for point in line.get("points").split():
                x, y = map(float, point.split(","))
                assert 0 < x < 760 and 0 < y < 380, f"{file.name}: {point}"
        assert "prefers-color-scheme:dark" in file.read_text()


def test_what_was_not_measured_stays_as_it_was_and_is_said(scene):
    page = saved(scene, kernel=False)
    before = page.read_text()
    status, said, after = written(scene, page)
    assert status == 1
    assert "rig: owsd direct (make bench-kernel) was not measured" in said, said

    def rig(text):
        begun = text.index("<!-- figures rig -->")
        return text[begun:text.index("<!-- end of figures -->", begun)]

    assert rig(after) == rig(before)
    assert "img/scan.svg" not in after and "img/latency.svg" in after


def test_a_busy_machine_is_told_on_the_page(scene):
    _, _, after = written(scene, saved(scene, load=7.5))
    assert "**The machine was not quiet (load 7.5)" in after


if __name__ == "__main__":
    owsdtest.main()
