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
 * The same about an alarm that no limit and no quality explains (enum ows_alarm_kind, enum
 * ows_alarm_event), and its words; "" else.
 */
const char *alarm_word(uint8_t kind, uint8_t event);
const char *alarm_cause(uint8_t kind, uint8_t event);
const char *alarm_remedy(uint8_t kind, uint8_t event);
