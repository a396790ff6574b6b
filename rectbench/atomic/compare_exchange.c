/* The one function of GCC's libatomic that Dr.Jit's thread pool (libnanothread) calls, for Linux x86-64
 * machines without that library: a bare Debian has none, and Dr.Jit's wheel does not bring it.
 *
 * It is kept built, as libatomic.so.1 beside this file, since it cannot be built where it is needed: on
 * Debian and Ubuntu GCC depends on libatomic1, so who lacks the library lacks the compiler. In this
 * folder, Debian 12's GCC 12.2.0 and binutils 2.40 make the same bytes of it (a test does) by
 *
 *   gcc -Os -mcx16 -shared -fPIC -nostdlib -fno-builtin -s -Wno-builtin-declaration-mismatch \
 *       -Wl,-soname,libatomic.so.1 -Wl,--version-script,libatomic.map -Wl,--build-id=none \
 *       -o libatomic.so.1 compare_exchange.c
 *
 * It is loaded only where the system has no libatomic. `lock cmpxchg16b` is a full barrier, so both
 * memory orders are met whatever they are.
 */
_Bool __atomic_compare_exchange_16(volatile void *object, void *expected, unsigned __int128 desired,
                                   int success_order, int failure_order)
{
    unsigned __int128 before = *(unsigned __int128 *)expected;
    unsigned __int128 found =
        __sync_val_compare_and_swap((volatile unsigned __int128 *)object, before, desired);
    (void)success_order;
    (void)failure_order;
    if (found == before)
        return 1;
    *(unsigned __int128 *)expected = found;
    return 0;
}
