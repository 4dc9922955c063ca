/* SPDX-License-Identifier: MIT */
/*
 * serial SCENARIO: a simulated wire behind a serial port, so that the genuine owserver reaches the
 * simulated chips without a kernel's driver. Prints the name of the pseudo-terminal, then serves it
 * until it is ended. The wire is channel 0 of the scenario's first chip.
 *
 * The adapter is the passive one: the DS9097, of Maxim's application note 214, "Using a UART to
 * Implement a 1-Wire Bus Master". Each byte of the host comes back as what the line made of it: F0
 * is a reset pulse, and comes back as E0 if a slave answers; a byte whose first bit is 1 is a slot
 * that writes 1 or reads, and comes back with low bits if the line was low; any other writes 0.
 */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "hal/sim/scenario.h"

enum { RESET = 0xF0, PRESENT = 0xE0, SLOT_WAS_LOW = 0xFE };
/* What the UART needs for a byte of 10 bits at 9600 and 115200 baud. */
#define RESET_NS 1041667
#define SLOT_NS 86806

/* What the wire would have taken so far. */
static int64_t spent_ns;

/*
 * The time of the simulation: a pseudo-terminal has a byte at once, so the time of the wire is
 * added to the real one. Chips then have all the time that they have on a true wire.
 */
static int64_t now(void)
{
	struct timespec time;

	clock_gettime(CLOCK_MONOTONIC, &time);
	return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec + spent_ns;
}

/* The host's byte, and what the line makes of it. */
static uint8_t echo(struct sim_net *net, uint8_t byte)
{
	struct sim_wire *wire = &net->chip[0].wire[0];
	int64_t at = now();

	sim_net_run(net, at);
	at -= net->epoch;
	spent_ns += byte == RESET ? RESET_NS : SLOT_NS;
	if (byte == RESET)
		return sim_wire_reset(wire, false, at) ? PRESENT : RESET;
	if (!(byte & 1)) {
		sim_wire_slot(wire, false, false, at);
		return byte;
	}
	return sim_wire_slot(wire, true, false, at) ? byte : byte & SLOT_WAS_LOW;
}

/* Until the port fails, which it does not: the host closes and opens it as it likes. */
static void serve(struct sim_net *net, int port)
{
	uint8_t bytes[4096];

	for (;;) {
		ssize_t n = read(port, bytes, sizeof(bytes));

		if (n <= 0)
			return;
		for (ssize_t i = 0; i < n; i++)
			bytes[i] = echo(net, bytes[i]);
		if (write(port, bytes, (size_t)n) != n)
			return;
	}
}

/* The master's side of a new pseudo-terminal; this process keeps the other side open too. */
static int open_port(void)
{
	int port = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC), end;
	struct termios raw;

	if (port < 0 || grantpt(port) || unlockpt(port))
		return -1;
	end = open(ptsname(port), O_RDWR | O_NOCTTY | O_CLOEXEC);
	if (end < 0 || tcgetattr(end, &raw))
		return -1;
	cfmakeraw(&raw);
	return tcsetattr(end, TCSANOW, &raw) ? -1 : port;
}

int main(int argc, char **argv)
{
	struct sim_net net;
	char why[256];
	int port;

	if (argc != 2) {
		fprintf(stderr, "usage: serial SCENARIO\n");
		return 2;
	}
	if (sim_scenario_read(argv[1], &net, why, sizeof(why))) {
		fprintf(stderr, "%s\n", why);
		return 1;
	}
	port = open_port();
	if (port < 0) {
		perror("no pseudo-terminal");
		return 1;
	}
	sim_net_start(&net, now());
	puts(ptsname(port));
	fflush(stdout);
	serve(&net, port);
	perror("the pseudo-terminal");
	return 1;
}
