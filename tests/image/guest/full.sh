# SPDX-License-Identifier: MIT
# A boot with devices and a full disk: the scan cannot be kept, which is said, and the service is up;
# with room it is made up for. Then what else may be wrong: a broken configuration, two masters.
. /run/rig/guest.sh

good() { owsctl -n "$1" get temperature1 >/dev/null; }
says() { owsctl -n "$1" get temperature1 2>&1 | grep -q -F -- "$2"; }

does 'with a full disk the service is up' within $start active owsd@OWS
same 'the disk is full' 0 "$(df --output=avail / | tail -n 1 | tr -d ' ')"
does 'the first start says so' within $patience said owsd-firstboot 'No space left'
does 'it counts as failed' within $patience systemctl -q is-failed owsd-firstboot
does 'the file is the packaged one' cmp $file $packaged
same 'nothing else lies beside it' OWS.rio "$(ls -A /etc/owsd)"
does 'without a mark' [ ! -e $done ]
journalctl -b -o short-monotonic --no-pager -u 'owsd*' | sed 's/^/# /'
rm -f /var/full /var/full.more
does 'with room on the disk it is started again' systemctl restart owsd-firstboot owsd@OWS
does 'there is a configuration' [ -e $done ]
does 'and a value' within $patience reads temperature1 21.0625

# A broken configuration
cp $file /tmp/good.rio
sed -i 's/^  MaxRetries .*/  MaxRetries  some/' $file
does 'with a broken configuration it does not start' refused systemctl restart owsd@OWS
does 'the place is said' said owsd@OWS "$file:"
does 'systemd goes on trying' within $patience sh -c '[ "$(systemctl show -P SubState owsd@OWS)" = auto-restart ]'
systemctl status --no-pager owsd@OWS | sed 's/^/# /'
owsctl get temperature1 2>&1 | sed 's/^/# get: /'
cp /tmp/good.rio $file
does 'mended it comes up by itself' within $patience active owsd@OWS
does 'with values' within $patience good OWS

# Two instances on one chip
sed 's/"auto"/"i2c:\/dev\/i2c-0"/' /tmp/good.rio >/etc/owsd/HOUSE.rio
does 'a second instance for the same chip starts' systemctl start owsd@HOUSE
does 'and is told who has it' within $patience says HOUSE 'in use by owsd'
does 'in its log too' within $patience said owsd@HOUSE 'in use by owsd'
does 'the first goes on' good OWS
does 'when that leaves' systemctl stop owsd@OWS
does 'the second has it' within $patience good HOUSE

# The kernel's driver on the same chip
does 'nobody has it' systemctl stop owsd@HOUSE
echo ds2482 0x18 >/sys/bus/i2c/devices/i2c-0/new_device
does 'with the chip in the hands of the kernel' [ -e /sys/bus/i2c/devices/0-0018/driver ]
does 'it starts' systemctl start owsd@HOUSE
does 'and says what mends it' within $patience said owsd@HOUSE '/sys/bus/i2c/drivers/ds2482/unbind'
does 'the service is up' active owsd@HOUSE
does 'no value is good' refused good HOUSE
does 'auto takes what the kernel has' systemctl start owsd@OWS
does 'and reads' within $patience good OWS
systemctl stop owsd@OWS
echo 0-0018 >/sys/bus/i2c/drivers/ds2482/unbind
does 'when the driver lets go, it has the chip' within $patience good HOUSE
journalctl -b -o short-monotonic --no-pager -n 60 -u 'owsd*' | sed 's/^/# /'
finish
