#!/bin/sh
# SPDX-License-Identifier: MIT
# owsd in real time, for as many minutes as the file /rig/endurance says, with faults of everything.
. /rig/lib.sh

read -r minutes seed </rig/endurance
cp /rig/endurance.rio /tmp/a.rio
# The other table: slower, and with a signal more
sed -e '$d' -e 's/^  Period .*/  Period 0.2/' -e '/ItemCount/d' /tmp/a.rio >/tmp/b.rio
cat >>/tmp/b.rio <<-END
	  Item {
	    Name "more"
	    Path "/28.A0B1C2000028/type"
	    Type "string"
	    IO "input"
	  }
	}
END
plug endurance.sim
# shellcheck disable=SC2034 # lib.sh looks at it
endurance "$minutes" "$seed" || failed=1
owsctl stats | sed 's/^/# /'
echo "# the log has $(wc -l </tmp/log/owsd) lines in $(wc -c </tmp/log/owsd) bytes"
finish
