/* SPDX-License-Identifier: MIT */
/*
 * A stand-in for the header of this name of OpenPLC 4's runtime: what a native plug-in meets of it,
 * declared in the same order, so that docs/examples/openplc/owsd.cpp is compiled and run by the
 * tests as a plug-in. docs/openplc.md says against which runtime it was tried.
 */
#pragma once

#include "tests/system/openplc/ladder.h"

struct plugin_runtime_args_t {
	IEC_BOOL *(*bool_input)[8], *(*bool_output)[8];
	IEC_BYTE **byte_input, **byte_output;
	IEC_UINT **int_input, **int_output;
	IEC_UDINT **dint_input, **dint_output;
	IEC_ULINT **lint_input, **lint_output;
	IEC_UINT **int_memory;
	IEC_UDINT **dint_memory;
	IEC_ULINT **lint_memory;
	IEC_BOOL *(*bool_memory)[8];
	void (*image_lock)(), (*image_unlock)();
	void (*debug[6])();
	char plugin_specific_config_file_path[256];
	int buffer_size, bits_per_buffer;
	void (*log_info)(const char *format, ...);
	void (*log_debug)(const char *format, ...);
	void (*log_warn)(const char *format, ...);
	void (*log_error)(const char *format, ...);
	int (*journal_write_bool)(int type, int index, int bit, int value);
	int (*journal_write_byte)(int type, int index, int value);
	int (*journal_write_int)(int type, int index, int value);
	int (*journal_write_dint)(int type, int index, unsigned int value);
	int (*journal_write_lint)(int type, int index, unsigned long long value);
	void (*request_plc_stop)(const char *reason);
	unsigned long long base_tick_ns;
};

extern "C" {
int init(void *args);
int start_loop();
void stop_loop();
void cycle_start();
void cycle_end();
void cleanup();
}
