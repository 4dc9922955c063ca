/* SPDX-License-Identifier: MIT */
/* The Web block, of which owsd-web takes its options. owsd checks it, and does not use it. */
#pragma once

#include "src/config/read/build.h"

block_derive web_derive;
