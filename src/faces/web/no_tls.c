/* SPDX-License-Identifier: MIT */
/*
 * Leaves GnuTLS asleep. Debian's libmicrohttpd is linked with it and starts it when a program is
 * loaded, which costs a megabyte of memory. owsd-web has no TLS (a reverse proxy has), so the
 * program answers in the place of GnuTLS: for its own start, by the function that GnuTLS has for
 * that (GNUTLS_SKIP_GLOBAL_INIT), and for the calls of libmicrohttpd.
 */
int _gnutls_global_init_skip(void); /* NOLINT(bugprone-reserved-identifier) */
int gnutls_global_init(void);
void gnutls_global_deinit(void);

int _gnutls_global_init_skip(void) /* NOLINT(bugprone-reserved-identifier) */
{
	return 1;
}

int gnutls_global_init(void)
{
	return 0;
}

void gnutls_global_deinit(void)
{
}
