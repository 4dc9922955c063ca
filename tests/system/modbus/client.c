/* SPDX-License-Identifier: MIT */
/*
 * A client by libmodbus for test_modbus_judges.py: reads the COUNT registers from FIRST on again
 * and again, until its output is closed. A line for each answer: the registers; "busy" for the
 * exception of that name. Ends with 1 and the reason for any other.
 *
 *     client PORT FIRST COUNT
 */
#include <errno.h>
#include <modbus.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int main(int argc, char **argv)
{
	uint16_t words[MODBUS_MAX_READ_REGISTERS];
	int first, count, n;
	modbus_t *modbus;

	if (argc != 4)
		return 2;
	first = atoi(argv[2]);
	count = atoi(argv[3]);
	modbus = modbus_new_tcp("127.0.0.1", atoi(argv[1]));
	/* its own half second is over where other programs have the processor */
	if (!modbus || modbus_set_response_timeout(modbus, 20, 0) || modbus_connect(modbus))
		goto failed;
	for (;;) {
		n = modbus_read_registers(modbus, first, count, words);
		if (n < 0 && errno == EMBXSBUSY)
			printf("busy");
		else if (n != count)
			goto failed;
		for (int i = 0; i < n; i++)
			printf("%u ", words[i]);
		printf("\n");
		if (fflush(stdout))
			return 0;
		usleep(20000); /* pace */
	}
failed:
	fprintf(stderr, "libmodbus: %s\n", modbus_strerror(errno));
	return 1;
}
