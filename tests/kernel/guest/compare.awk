# SPDX-License-Identifier: MIT
# Two outputs of owdump for the same paths, the peer's first: one result for each device whose
# answers are all equal, one for each answer that is not. what names the comparison. Running clocks
# (date, udate) may differ by the seconds between the two; any refusal equals any other; and where
# owserver tells 85 degrees of a thermometer that never converted, owsd tells a power fault.
BEGIN { FS = "\t" }

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
	else if (theirs[$1] ~ /^ret=-/ && $2 ~ /^ret=-/)
		good[id]++
	else if (theirs[$1] ~ /^ *85$/ && $2 == "ret=-34")
		good[id]++
	else if (theirs[$1] != $2)
		bad($1, "owserver '" theirs[$1] "', owsd '" $2 "'")
	else
		good[id]++
	total[id]++
}

function close_to(a, b) {
	if (a ~ /^ *[0-9]+$/ && b ~ /^ *[0-9]+$/)
		return a - b < 600 && b - a < 600
	return length(a) == 24 && length(b) == 24
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
