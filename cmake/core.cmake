# The core of the page's explorer (web/explorer.c) as WebAssembly, where a clang with wasi-libc is at hand.
#
# Sets DEA_CORE: the file, or nothing.
set(DEA_CORE)
find_program(DEA_WASM_CC NAMES clang-14 clang)
set(core_flags --target=wasm32-wasi -mexec-model=reactor)
if(DEA_WASM_CC AND NOT DEA_WASM_WORKS) # a "no" is tried again: packages may have come
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/core_check.c "#include <math.h>\nextern double x;\ndouble x;\n\
__attribute__((export_name(\"f\"))) int f(void) { return pow(x, 2) > 1; }\n")
  execute_process(COMMAND ${DEA_WASM_CC} ${core_flags} core_check.c -o core_check.wasm
    WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
  if(result EQUAL 0)
    set(works YES)
  else()
    set(works NO)
    message(STATUS "No compiler for WebAssembly (clang, lld, wasi-libc, libclang-rt-dev-wasm32): reports without explorer")
  endif()
  set(DEA_WASM_WORKS ${works} CACHE INTERNAL "clang compiles for WebAssembly")
endif()
if(DEA_WASM_WORKS)
  set(core_sources ${PROJECT_SOURCE_DIR}/web/explorer.c ${PROJECT_SOURCE_DIR}/web/dense_wasm.c)
  foreach(name IN ITEMS base/context base/status base/quadrature material/law material/plane device/device_check model/film model/make
      result/load_point model/equilibrium_path model/alpha model/circuit material/branch model/lumped/balance model/lumped/motion
      model/lumped/lift model/lumped/lumped_model)
    list(APPEND core_sources ${CMAKE_CURRENT_SOURCE_DIR}/${name}.c)
  endforeach()
  file(GLOB core_found CONFIGURE_DEPENDS material/law_*.c model/axisymmetric/*.c)
  file(GLOB core_headers CONFIGURE_DEPENDS base/*.h material/*.h design/*.h device/*.h model/*.h model/lumped/*.h waveform/*.h
    model/axisymmetric/*.h)
  list(APPEND core_sources ${core_found})
  set(DEA_CORE ${CMAKE_CURRENT_BINARY_DIR}/explorer.wasm)
  add_custom_command(OUTPUT ${DEA_CORE}
    COMMAND ${DEA_WASM_CC} ${core_flags} -std=c17 -O2 -flto -DNDEBUG -D_WASI_EMULATED_SIGNAL
      -ffile-prefix-map=${PROJECT_SOURCE_DIR}/= -I${CMAKE_CURRENT_SOURCE_DIR} ${core_sources}
      -Wl,--strip-all,-z,stack-size=262144 -o ${DEA_CORE}
    DEPENDS ${core_sources} ${core_headers} COMMENT "Compiling the explorer's core for WebAssembly" VERBATIM)
endif()
