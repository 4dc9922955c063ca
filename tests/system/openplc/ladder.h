/* SPDX-License-Identifier: MIT */
/*
 * A stand-in for OpenPLC's header of this name: what a hardware layer meets of the runtime,
 * declared as there, so that docs/examples/openplc/owsd.cpp is compiled and run by the tests. The
 * runtime itself is another project under the GPL; docs/openplc.md says against which one the
 * example was tried.
 */
#pragma once

#include <pthread.h>
#include <stdint.h>

#define BUFFER_SIZE 1024

typedef uint8_t IEC_BOOL;
typedef uint8_t IEC_BYTE;
typedef uint16_t IEC_UINT;
typedef uint32_t IEC_UDINT;
typedef uint64_t IEC_ULINT;

extern IEC_BOOL *bool_input[BUFFER_SIZE][8];
extern IEC_BOOL *bool_output[BUFFER_SIZE][8];
extern IEC_BYTE *byte_input[BUFFER_SIZE];
extern IEC_BYTE *byte_output[BUFFER_SIZE];
extern IEC_UINT *int_input[BUFFER_SIZE];
extern IEC_UINT *int_output[BUFFER_SIZE];
extern IEC_UDINT *dint_input[BUFFER_SIZE];
extern IEC_UDINT *dint_output[BUFFER_SIZE];
extern IEC_ULINT *lint_input[BUFFER_SIZE];
extern IEC_ULINT *lint_output[BUFFER_SIZE];

extern pthread_mutex_t bufferLock;
extern unsigned long long common_ticktime__;

void initializeHardware();
void finalizeHardware();
void updateBuffersIn();
void updateBuffersOut();
extern "C" void openplc_log(char *logmsg);
