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
