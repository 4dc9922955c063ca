/* SPDX-License-Identifier: MIT */
#include "hal/native/lcd.h"

#include <errno.h>

int lcd_refuse(struct txn *txn)
{
	(void)txn;
	return -EOPNOTSUPP;
}
