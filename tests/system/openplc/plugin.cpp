// SPDX-License-Identifier: MIT
//
// OpenPLC 4's runtime towards a native plug-in, for plc.cpp beside it: its arguments end with init(),
// and what it writes into the journal stands in the cells from the start of the next cycle on.
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "tests/system/openplc/plugin_types.h"

namespace {

struct Entry {
	int type, index, bit;
	unsigned long long value;
};
std::vector<Entry> journal;

int note(int type, int index, int bit, unsigned long long value)
{
	journal.push_back({type, index, bit, value});
	return 0;
}

int write_bool(int type, int index, int bit, int value)
{
	return note(type, index, bit, (unsigned)value);
}

int write_int(int type, int index, int value)
{
	return note(type, index, 0, (unsigned)value);
}

int write_dint(int type, int index, unsigned value)
{
	return note(type, index, 0, value);
}

int write_lint(int type, int index, unsigned long long value)
{
	return note(type, index, 0, value);
}

// By the numbers of the runtime's own header
void apply(const Entry &e)
{
	switch (e.type) {
	case 0:
		*bool_input[e.index][e.bit] = e.value & 1;
		return;
	case 3:
		*byte_input[e.index] = (IEC_BYTE)e.value;
		return;
	case 5:
		*int_input[e.index] = (IEC_UINT)e.value;
		return;
	case 8:
		*dint_input[e.index] = (IEC_UDINT)e.value;
		return;
	case 11:
		*lint_input[e.index] = e.value;
		return;
	}
	std::abort();
}

__attribute__((format(printf, 1, 2))) void print(const char *format, ...)
{
	va_list args;

	va_start(args, format);
	std::printf("log ");
	std::vprintf(format, args);
	std::printf("\n");
	std::fflush(stdout);
	va_end(args);
}

} // namespace

void initializeHardware()
{
	plugin_runtime_args_t args;
	const char *map = std::getenv("OWSD_OPENPLC_MAP");
	int err;

	std::memset(&args, 0, sizeof(args));
	args.bool_input = bool_input, args.bool_output = bool_output;
	args.byte_input = byte_input, args.byte_output = byte_output;
	args.int_input = int_input, args.int_output = int_output;
	args.dint_input = dint_input, args.dint_output = dint_output;
	args.lint_input = lint_input, args.lint_output = lint_output;
	std::snprintf(args.plugin_specific_config_file_path,
	              sizeof(args.plugin_specific_config_file_path), "%s", map);
	unsetenv("OWSD_OPENPLC_MAP");
	args.buffer_size = BUFFER_SIZE;
	args.bits_per_buffer = 8;
	args.log_info = args.log_error = print;
	args.journal_write_bool = write_bool;
	args.journal_write_byte = args.journal_write_int = write_int;
	args.journal_write_dint = write_dint;
	args.journal_write_lint = write_lint;
	args.base_tick_ns = common_ticktime__;
	err = init(&args);
	std::memset(&args, 0xff, sizeof(args));
	if (err || start_loop())
		std::exit(EXIT_FAILURE);
}

void finalizeHardware()
{
	stop_loop();
	cleanup();
}

void updateBuffersIn()
{
	for (const Entry &e : journal)
		apply(e);
	journal.clear();
	cycle_start();
}

void updateBuffersOut()
{
	cycle_end();
}
