/* SPDX-License-Identifier: BSD-3-Clause */
/* Defaults of AddressSanitizer, which ASAN_OPTIONS may change, in every program of a build with it.
 *
 * GCC 12's libasan may take the thread-local memory of a driver (Mesa's) for that of an old glibc, and reads the size
 * of the block from its own bookkeeping. LeakSanitizer then follows an address that is none and ends the program with
 * "Tracer caught signal 11". Leaks are looked for as before. */
const char *__asan_default_options(void);

const char *__asan_default_options(void)
{
    return "intercept_tls_get_addr=0";
}

/* Libraries stay. What a driver keeps in variables of its own until the program ends would count as lost once the
 * driver is unloaded, as it is when a window closes before its first picture is drawn. */
int dlclose(void *library);

int dlclose(void *library)
{
    (void)library;
    return 0;
}
