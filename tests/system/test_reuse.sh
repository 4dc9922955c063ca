#!/bin/sh
# SPDX-License-Identifier: MIT
# The licence and the holder of each file are said in the way that REUSE 3.3 asks for
set -eu

reuse=reuse==6.2.0
place=${XDG_CACHE_HOME:-$HOME/.cache}/owsd/$reuse
mkdir -p "${place%/*}"
exec 9>"$place.lock"
flock 9
if [ ! -e "$place/whole" ]; then
	rm -rf "$place"
	if ! { python3 -m venv "$place" &&
		"$place/bin/pip" -q --disable-pip-version-check --retries 1 --timeout 30 install $reuse; } >log 2>&1; then
		rm -rf "$place"
		tail -n 1 log
		echo "not cached and cannot be had: $reuse"
		exit 77
	fi
	touch "$place/whole"
fi
exec 9>&-
"$place/bin/reuse" --root "$OWSD_SOURCE" lint --lines
