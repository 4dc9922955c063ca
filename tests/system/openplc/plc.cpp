// SPDX-License-Identifier: MIT
//
// A PLC for the tests of docs/examples/openplc/owsd.cpp: the order of calls of OpenPLC's main loop,
// and in place of a program a person at the standard input:
//
//     set Q X INDEX BIT VALUE     set an output's cell, as a number of its bits
//     show I W INDEX 0            print a cell
//     thermostat                  from now on do as docs/examples/openplc/thermostat.st does
//     stop                        as OpenPLC stops; so does the end of the input
#include <cstdio>
#include <cstring>
#include <iostream>
#include <poll.h>
#include <sstream>
#include <string>
#include <unistd.h>

#include "tests/system/openplc/ladder.h"

IEC_BOOL *bool_input[BUFFER_SIZE][8], *bool_output[BUFFER_SIZE][8];
IEC_BYTE *byte_input[BUFFER_SIZE], *byte_output[BUFFER_SIZE];
IEC_UINT *int_input[BUFFER_SIZE], *int_output[BUFFER_SIZE];
IEC_UDINT *dint_input[BUFFER_SIZE], *dint_output[BUFFER_SIZE];
IEC_ULINT *lint_input[BUFFER_SIZE], *lint_output[BUFFER_SIZE];
pthread_mutex_t bufferLock = PTHREAD_MUTEX_INITIALIZER;
unsigned long long common_ticktime__ = 20000000;

extern "C" void openplc_log(char *logmsg)
{
	std::cout << "log " << logmsg << std::flush;
}

namespace {

// Cells 0 to 15 of each kind; the others are those that a program does not have
const unsigned CELLS = 16;
IEC_BOOL bits[2][CELLS][8];
IEC_BYTE bytes[2][CELLS];
IEC_UINT words[2][CELLS];
IEC_UDINT doubles[2][CELLS];
IEC_ULINT longs[CELLS];

void glue()
{
	for (unsigned i = 0; i < CELLS; i++) {
		for (unsigned bit = 0; bit < 8; bit++) {
			bool_input[i][bit] = &bits[0][i][bit];
			bool_output[i][bit] = &bits[1][i][bit];
		}
		byte_input[i] = &bytes[0][i];
		byte_output[i] = &bytes[1][i];
		int_input[i] = &words[0][i];
		int_output[i] = &words[1][i];
		dint_input[i] = &doubles[0][i];
		dint_output[i] = &doubles[1][i];
		lint_input[i] = &longs[i];
	}
}

unsigned long long read_cell(bool out, char size, unsigned i, unsigned bit)
{
	switch (size) {
	case 'X':
		return bits[out][i][bit];
	case 'B':
		return bytes[out][i];
	case 'W':
		return words[out][i];
	case 'D':
		return doubles[out][i];
	}
	return longs[i];
}

void write_cell(char size, unsigned i, unsigned bit, unsigned long long value)
{
	switch (size) {
	case 'X':
		bits[1][i][bit] = (IEC_BOOL)value;
		return;
	case 'B':
		bytes[1][i] = (IEC_BYTE)value;
		return;
	case 'W':
		words[1][i] = (IEC_UINT)value;
		return;
	case 'D':
		doubles[1][i] = (IEC_UDINT)value;
		return;
	}
}

void thermostat()
{
	int16_t room = (int16_t)words[0][0];

	if (!bits[0][0][0])
		bits[1][0][0] = 0;
	else if (room < 2050)
		bits[1][0][0] = 1;
	else if (room > 2150)
		bits[1][0][0] = 0;
}

bool runs_thermostat;

// False: stop
bool obey(const std::string &line)
{
	std::istringstream words_of(line);
	std::string verb;
	char area = 0, size = 0;
	unsigned i = 0, bit = 0;
	unsigned long long value = 0;

	words_of >> verb;
	if (verb == "thermostat")
		runs_thermostat = true;
	if (verb == "stop")
		return false;
	if (!(words_of >> area >> size >> i >> bit) || i >= CELLS || bit > 7)
		return true;
	if (verb == "set" && words_of >> value)
		write_cell(size, i, bit, value);
	if (verb == "show")
		std::cout << "cell " << read_cell(area == 'Q', size, i, bit) << std::endl;
	return true;
}

bool obey_all(std::string &rest)
{
	struct pollfd input = { 0, POLLIN, 0 };
	char text[512];
	size_t end;

	if (poll(&input, 1, 0) == 1) {
		ssize_t n = read(0, text, sizeof(text));

		if (n <= 0)
			return false;
		rest.append(text, (size_t)n);
	}
	while ((end = rest.find('\n')) != std::string::npos) {
		std::string line = rest.substr(0, end);

		rest.erase(0, end + 1);
		if (!obey(line))
			return false;
	}
	return true;
}

} // namespace

int main()
{
	std::string rest;
	bool on = true;

	initializeHardware();
	updateBuffersIn();
	updateBuffersOut();
	glue();
	while (on) {
		updateBuffersIn();
		pthread_mutex_lock(&bufferLock);
		if (runs_thermostat)
			thermostat();
		on = obey_all(rest);
		pthread_mutex_unlock(&bufferLock);
		updateBuffersOut();
		usleep((useconds_t)(common_ticktime__ / 1000));
	}
	// All outputs to 0, but those of 32 bits
	std::memset(bits[1], 0, sizeof(bits[1]));
	std::memset(bytes[1], 0, sizeof(bytes[1]));
	std::memset(words[1], 0, sizeof(words[1]));
	updateBuffersOut();
	finalizeHardware();
	return 0;
}
