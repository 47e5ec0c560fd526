# What limits the harm of a write beyond memory that no test found, in all that is built: a mark on the
# stack, checked copies (glibc's, with optimisation only; sanitizers bring their own), tables of addresses
# that are read-only once a program runs. `tests/style/check_hardened.sh` looks for them in what was built.
target_compile_options(dea_flags INTERFACE -fstack-protector-strong)
if(NOT DEA_SANITIZE)
  target_compile_options(dea_flags INTERFACE
    $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2>)
endif()
target_link_options(dea_flags INTERFACE LINKER:-z,relro LINKER:-z,now LINKER:-z,noexecstack)
