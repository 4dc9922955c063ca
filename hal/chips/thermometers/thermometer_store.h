/* SPDX-License-Identifier: MIT */
/*
 * The user's settings of a thermometer go to its EEPROM, so that they outlive its power. Copy
 * Scratchpad (48h) takes all of them along, and in the scratchpad may be others than in the EEPROM:
 * the resolution of a conversion, limits that a program which was killed has left. So what is
 * copied is what the EEPROM has, but for the setting that is written:
 *
 *   LOOK      what is in the scratchpad?
 *   RECALL    recall it from the EEPROM (B8h). A recall says nothing, and may be lost: only what
 *             it changes proves it.
 *   WRITE     the setting to the scratchpad, and read it back
 *   PROBE     nothing is proven yet: then a recall takes the setting away again. A chip that keeps
 *             it may not know the command. It gets back what it had: -EIO.
 *   COPY      and then recall it three times: if the copy was lost, what was before comes back.
 *
 * What the EEPROM has already is not written again, as it wears out. What is in force is what stood
 * there or what is wanted, at each moment. A driver knows no recall: there it is as it says.
 *
 * Both are called until they return something else than TXN_MORE. 0; -EINVAL: the chip does not
 * take it; -EIO: it was not kept, or nothing shows what the EEPROM has. Commands: data sheets
 * 19-7487 and 19-5474. The files of the families include this for THERMOMETER_WAYS.
 */
#pragma once

#include "hal/wire/txn.h"

int thermometer_write_limit(struct txn *txn); /* of the field's byte */
int thermometer_write_tempres(struct txn *txn);
