/* SPDX-License-Identifier: MIT */
/*
 * The addresses where owsd serves the owserver protocol (PORT, HOST:PORT, [IPv6]:PORT), and the
 * peers that it serves (addresses or ranges). Only numeric, so that owsd asks no name server. Pure
 * functions.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

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
 * Read one address (len bytes). `4304` and `localhost:4304` mean both loopback addresses, so the
 * function stores one or two addresses. Returns how many, or -EINVAL with the reason in *why.
 */
int listen_parse(const char *text, size_t len, struct listen_address addresses[2],
                 const char **why);
/* Read peers: "192.168.1.0/24", "10.0.0.7", "fd00::/8". 0, or -EINVAL with the reason in *why. */
int listen_peers_parse(const char *text, size_t len, struct listen_peers *peers, const char **why);

bool listen_is_loopback(const struct listen_address *address);
bool listen_same(const struct listen_address *a, const struct listen_address *b);
bool listen_same_peers(const struct listen_peers *a, const struct listen_peers *b);
/* Is the address among the peers? IPv4 addresses in IPv6 form count as IPv4. */
bool listen_peers_have(const struct listen_peers *peers, unsigned count, bool is_v6,
                       const uint8_t *bytes);
/* "127.0.0.1:4304", "[::1]:4304"; without the port "127.0.0.1", "::1" */
#define LISTEN_TEXT_MAX 56
/*
 * As a socket has it, and back: an IPv4 address is the same whether it comes mapped or not. False:
 * it is of another family.
 */
void listen_sockaddr(const struct listen_address *address, struct sockaddr_storage *to);
bool listen_of(const struct sockaddr *from, struct listen_address *address);
void listen_print(const struct listen_address *address, char text[LISTEN_TEXT_MAX]);
void listen_print_host(const struct listen_address *address, char text[LISTEN_TEXT_MAX]);
/* Why nobody is served there, without a remedy (ground/service/listen.h). */
#define LISTEN_WHY_MAX 160
void listen_why(const struct listen_address *address, int err, char text[LISTEN_WHY_MAX]);
void listen_peers_print(const struct listen_peers *peers, char text[LISTEN_TEXT_MAX]);
