# SPDX-License-Identifier: MIT
# After a power cut, and after a reboot: the configuration is the one that was there, the first start
# is not made again, outputs are as the configuration says, because both end what was commanded.
. /run/rig/guest.sh

first_value temperature1 'later boot'
echo "@@RIG-SAME configuration $(sha256sum <$file)"
echo "@@RIG-SAME mark-of-the-first-start $(stat -c %Y $done)"
same 'the first start was not made again' no "$(systemctl show -P ConditionResult owsd-firstboot)"
same 'the service was never started twice' 0 "$(systemctl show -P NRestarts owsd@OWS)"
does 'the signal that was added is there' within $patience owsctl get hall
does 'the output has its start value' within $patience reads outputs1 2
does 'on the chip, too' within $patience reads inputs1 189
echo '@@RIG-OUTSIDE /28.A0B1C2010028/temperature -10.125'
echo '@@RIG-OUTSIDE /signals/temperature1 21.0625'
# done in this order, so it has been asked when this has come
echo '@@RIG-OUTSIDE-SET /signals/outputs1 6'
does 'what is set from outside the chip has' within $patience reads inputs1 185
same 'nothing has failed' '' "$(systemctl --failed --plain --no-legend)"
restart
