/* SPDX-License-Identifier: MIT */
/* The Modbus block, of which owsd-modbus takes its options. owsd checks it, and does not use it. */
#pragma once

#include "src/config/read/build.h"

block_derive modbus_derive;
/* Does Allow (NULL: nobody) let a client at that address command the signal? Pure. */
bool modbus_allows(const char *allow, const char *name, const struct listen_address *from);
