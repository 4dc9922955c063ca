/* SPDX-License-Identifier: MIT */
/* What owsd-mqtt does with what a broker asks for and sends; ctx is the struct mqtt. */
#pragma once

#include "src/faces/mqtt/client.h"

extern const struct broker_ops arrivals_ops;
