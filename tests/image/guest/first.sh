# SPDX-License-Identifier: MIT
# The first boot: everything comes up by itself, a configuration is made of what is there, consumers
# inside and outside read it; then the power goes.
. /run/rig/guest.sh

first_value temperature1 'first boot, with its scan'
does 'the service is up' active owsd@OWS
same 'it was never started twice' 0 "$(systemctl show -P NRestarts owsd@OWS)"
same 'the scan of the first start succeeded' success "$(systemctl show -P Result owsd-firstboot)"
does 'and is marked as done' [ -e $done ]
does 'it says what it did' said owsd-firstboot '/etc/owsd/OWS.rio: 6 signals of what was found'
same 'the file belongs to root and all may read it' '644 root' "$(stat -c '%a %U' $file)"
same 'nothing else lies beside it' OWS.rio "$(ls -A /etc/owsd)"
same 'the adapter belongs to its group' '660 i2c' "$(stat -c '%a %G' /dev/i2c-0)"
same 'owsd took the chip by itself' auto "$(sed -n 's/.*TargetName *"\(.*\)"/\1/p' $file)"

# Inside
does 'all signals are good' within $patience owsctl get temperature1 temperature2 inputs1 outputs1 counter_a1 counter_b1
reader OWS 2 >/tmp/reader
does 'a C program has them through the shared library' grep -q 'temperature1  *21.0625  *good' /tmp/reader
does 'all of them' grep -q 'counter_b1  *70000  *good' /tmp/reader
python3 -c '
import ows
with ows.Ows(control=True) as signals:
    cold = signals.get("temperature2")
    print(cold.value, cold.good)
    signals.set("outputs1", 5)
' >/tmp/python 2>&1
same 'a Python program too' '-10.125 True' "$(cat /tmp/python)"
does 'and sets an output' within $patience reads outputs1 5
# Inputs that the board holds low, and those of the outputs that are on
does 'which the chip has' within $patience reads inputs1 184

# What an engineer does next: a name of his own, a start value, the network
does 'the file is edited' owsctl config $file set outputs1 InitValue=2
does 'and a signal added' owsctl config $file add hall /28.A0B1C2000028/fasttemp Type=double IO=input
sed -i 's/^  TargetName.*/&\n  Listen "4304, 10.0.2.15:4304"\n  ListenAllow "10.0.2.2"/' $file
does 'the file is right' owsd --check
sync $file # as an editor does
does 'the service is restarted with it' systemctl restart owsd@OWS
# The program that set 5 has ended
does 'the output has its start value' within $patience reads outputs1 2
echo '@@RIG-OUTSIDE /28.A0B1C2000028/temperature 21.0625'
echo '@@RIG-OUTSIDE /signals/temperature2 -10.125'
echo '@@RIG-OUTSIDE-SET /signals/outputs1 6'
does 'what is set from outside the chip has' within $patience reads inputs1 185
echo "@@RIG-KEEP configuration $(sha256sum <$file)"
echo "@@RIG-KEEP mark-of-the-first-start $(stat -c %Y $done)"
cut
