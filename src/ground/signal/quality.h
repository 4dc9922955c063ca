/* SPDX-License-Identifier: MIT */
#pragma once

#include <stdint.h>

/*
 * Sentences for people about a quality (enum ows_quality): what owsd has seen, and what to do. ""
 * where it is good, or no quality of owsd's. They live as long as the program. Its word is
 * ows_quality_text().
 */
const char *quality_cause(uint8_t quality);
const char *quality_remedy(uint8_t quality);

/*
 * The health of a device in the five words of NAMUR NE 107, numbered as DeviceHealth of OPC UA
 * (OPC 10000-100) is.
 */
enum device_health {
	HEALTH_NORMAL,
	HEALTH_FAILURE,     /* no value, or one that cannot be used */
	HEALTH_CHECK,       /* no value for now, because of what people do: simulated, disabled */
	HEALTH_OFF_SPEC,    /* a value outside of what it may be */
	HEALTH_MAINTENANCE, /* good values, with more errors than a sound wire has */
};
const char *health_word(enum device_health health);
/* What a quality says of its device. */
enum device_health quality_health(uint8_t quality);

/*
 * The same about an alarm that no limit and no quality explains (enum ows_alarm_kind, enum
 * ows_alarm_event), and its words; "" else.
 */
const char *alarm_word(uint8_t kind, uint8_t event);
const char *alarm_cause(uint8_t kind, uint8_t event);
const char *alarm_remedy(uint8_t kind, uint8_t event);
