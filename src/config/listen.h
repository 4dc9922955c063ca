/* SPDX-License-Identifier: MIT */
/*
 * Where the owserver protocol is served, and to whom: PORT, HOST:PORT, [IPv6]:PORT; peers as
 * addresses or ranges. Numeric addresses, so that no name server is asked. Pure functions.
 */
#ifndef CONFIG_LISTEN_H
#define CONFIG_LISTEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LISTEN_MAX 16
#define LISTEN_PEERS_MAX 64
#define LISTEN_PORT 4304

struct listen_address {
	bool is_v6;
	uint8_t bytes[16]; /* 4 or 16 are used */
	uint16_t port;     /* 0: the kernel chooses */
};

struct listen_peers {
	bool is_v6;
	uint8_t bytes[16];
	unsigned bits; /* of the address that count */
};

/*
 * Read one address (len bytes). `4304` and `localhost:4304` are both loopback addresses, so one or
 * two are put into addresses (room for 2). Returns how many, or -EINVAL, the reason in *why.
 */
int listen_parse(const char *text, size_t len, struct listen_address addresses[2],
                 const char **why);
/* "192.168.1.0/24", "10.0.0.7", "fd00::/8". 0 or -EINVAL, the reason in *why. */
int listen_peers_parse(const char *text, size_t len, struct listen_peers *peers, const char **why);

bool listen_is_loopback(const struct listen_address *address);
bool listen_same(const struct listen_address *a, const struct listen_address *b);
bool listen_same_peers(const struct listen_peers *a, const struct listen_peers *b);
/* IPv4 addresses in IPv6 form count as IPv4. */
bool listen_peers_have(const struct listen_peers *peers, unsigned count, bool is_v6,
                       const uint8_t *bytes);
/* "127.0.0.1:4304", "[::1]:4304" */
#define LISTEN_TEXT_MAX 56
void listen_print(const struct listen_address *address, char text[LISTEN_TEXT_MAX]);
void listen_peers_print(const struct listen_peers *peers, char text[LISTEN_TEXT_MAX]);

#endif
