/* SPDX-License-Identifier: MIT */
/*
 * sandbox CALLS FAMILIES PROGRAM [ARGUMENT]...: PROGRAM, given by its path, with no other system
 * calls than those whose numbers CALLS lists, as ranges, and no other sockets than of these address
 * families, as systemd's SystemCallFilter= and RestrictAddressFamilies= make it: EPERM and
 * EAFNOSUPPORT.
 */
#include <errno.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#define NATIVE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define NATIVE AUDIT_ARCH_AARCH64
#else
#define NATIVE 0
#endif

#define MOST 4000 /* the kernel takes 4096 */

static struct sock_filter code[MOST + 8];
static unsigned short used;

static void add(unsigned short op, unsigned value, unsigned char yes, unsigned char no)
{
	if (used < MOST)
		code[used++] = (struct sock_filter)BPF_JUMP(op, value, yes, no);
}

static void load(size_t offset)
{
	add(BPF_LD | BPF_W | BPF_ABS, (unsigned)offset, 0, 0);
}

static void end(unsigned action)
{
	add(BPF_RET | BPF_K, action, 0, 0);
}

/* Ranges "FIRST-LAST" between commas: what is in one is allowed. */
static void allow(const char *list)
{
	char *next;

	for (const char *at = list; *at; at = *next ? next + 1 : next) {
		add(BPF_JMP | BPF_JGE | BPF_K, (unsigned)strtoul(at, &next, 10), 0, 2);
		add(BPF_JMP | BPF_JGT | BPF_K, (unsigned)strtoul(next + 1, &next, 10), 1, 0);
		end(SECCOMP_RET_ALLOW);
	}
}

int main(int argc, char **argv)
{
	struct sock_fprog program = {.filter = code};
	unsigned short jump;

	if (argc < 4 || !NATIVE) {
		fputs("usage: sandbox CALLS FAMILIES PROGRAM [ARGUMENT]...\n", stderr);
		return 2;
	}
	load(offsetof(struct seccomp_data, arch));
	add(BPF_JMP | BPF_JEQ | BPF_K, NATIVE, 1, 0);
	end(SECCOMP_RET_KILL_PROCESS);
	load(offsetof(struct seccomp_data, nr));
	/* a socket is looked at twice: whether it may be made at all stands in CALLS */
	add(BPF_JMP | BPF_JEQ | BPF_K, SYS_socket, 0, 0);
	jump = (unsigned short)(used - 1);
	load(offsetof(struct seccomp_data, args));
	allow(argv[2]);
	end(SECCOMP_RET_ERRNO | EAFNOSUPPORT);
	code[jump].jf = (unsigned char)(used - jump - 1);
	allow(argv[1]);
	end(SECCOMP_RET_ERRNO | EPERM);
	program.len = used;
	if (used >= MOST || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) ||
	    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program)) {
		fprintf(stderr, "sandbox: %s\n", strerror(errno));
		return 125;
	}
	execv(argv[3], argv + 3);
	fprintf(stderr, "sandbox: %s: %s\n", argv[3], strerror(errno));
	return 126;
}
