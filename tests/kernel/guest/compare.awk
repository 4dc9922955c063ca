# SPDX-License-Identifier: MIT
# Two outputs of owdump for the same paths, the peer's first: one result for each device whose
# answers are all equal, one for each answer that is not. what names the comparison, peer and ours
# the two (owserver, owsd). Running clocks
# (date, udate, and the four bytes behind them in page 1 of a DS2438) may differ by the seconds
# between the two; any refusal equals any other; and where owserver tells 85 degrees of a thermometer
# that never converted, owsd tells a power fault.
BEGIN {
	FS = "\t"
	if (!peer)
		peer = "owserver"
	if (!ours)
		ours = "owsd"
	CLOCK["1"] = 0
	CLOCK["ALL"] = 8
	for (i = 32; i < 127; i++)
		ORD[sprintf("%c", i)] = i
}

function device(path,   parts) {
	sub(/^\/uncached/, "", path)
	split(path, parts, "/")
	return parts[2]
}

NR == FNR { theirs[$1] = $2; next }

{
	id = device($1)
	seen[$1] = 1
	if (!($1 in theirs))
		bad($1, "is not in the peer's answers")
	else if ($1 ~ /(^|\/)u?date$/ && close_to(theirs[$1], $2))
		good[id]++
	else if ($1 ~ /\/26\.[0-9A-F]+\/pages\/page\.(1|ALL)$/ && same_page($1, theirs[$1], $2))
		good[id]++
	else if (theirs[$1] ~ /^ret=-/ && $2 ~ /^ret=-/)
		good[id]++
	else if (theirs[$1] ~ /^ *85$/ && $2 == "ret=-34")
		good[id]++
	else if (theirs[$1] != $2)
		bad($1, peer " '" theirs[$1] "', " ours " '" $2 "'")
	else
		good[id]++
	total[id]++
}

function close_to(a, b) {
	if (a ~ /^ *[0-9]+$/ && b ~ /^ *[0-9]+$/)
		return a - b < 600 && b - a < 600
	return length(a) == 24 && length(b) == 24
}

# Bytes of an escaped text into out; how many
function bytes(text, out,   n, digits) {
	digits = "0123456789abcdef"
	for (n = 0; text != ""; n++) {
		if (substr(text, 1, 2) == "\\x") {
			out[n] = index(digits, substr(text, 3, 1)) * 16 + index(digits, substr(text, 4, 1)) - 17
			text = substr(text, 5)
		} else {
			out[n] = ORD[substr(text, 1, 1)]
			text = substr(text, 2)
		}
	}
	return n
}

# All but the clock is equal, and that runs
function same_page(path, a, b,   x, y, at, i, n, first, second) {
	sub(/.*\./, "", path)
	at = CLOCK[path]
	n = bytes(a, x)
	if (bytes(b, y) != n || n < at + 8)
		return 0
	for (i = 0; i < n; i++)
		if ((i < at || i > at + 3) && x[i] != y[i])
			return 0
	for (i = 3; i >= 0; i--) {
		first = first * 256 + x[at + i]
		second = second * 256 + y[at + i]
	}
	return first - second < 600 && second - first < 600
}

function bad(path, why) {
	print "not ok - " what " " path ": " why
	failed = 1
}

END {
	for (path in theirs)
		if (!(path in seen))
			bad(path, "no answer")
	for (id in total)
		if (good[id] == total[id])
			print "ok - " what " " id ": " total[id] " properties equal"
	exit failed
}
