// The first two Sobol dimensions, a (0,2)-sequence in base 2, without a table; and Owen scrambling by a hash.
//
// Points are built with their bits reversed (bit 0 is worth 1/2, bit 1 is worth 1/4, ...): there the first coordinate
// is the index itself, the second is Pascal's triangle mod 2 applied to it, and the Owen hash wants them so anyway.
#pragma once

#include <cstdint>

#include "sampling/hd.h"

namespace abn {

/// The 32 bits in reverse order.
ABN_HD constexpr std::uint32_t reverse_bits(std::uint32_t v) {
  v = ((v >> 1) & 0x55555555U) | ((v & 0x55555555U) << 1);
  v = ((v >> 2) & 0x33333333U) | ((v & 0x33333333U) << 2);
  v = ((v >> 4) & 0x0F0F0F0FU) | ((v & 0x0F0F0F0FU) << 4);
  // Plus and times instead of or and shift: GCC takes the usual form for a byte swap and then does not vectorise.
  v = ((v >> 8) & 0x00FF00FFU) + (v & 0x00FF00FFU) * 256U;
  return (v >> 16) | (v << 16);
}

/// Second coordinate, bits reversed, of Sobol point i: bit k is the parity of the bits j of i with C(j,k) odd, that is
/// (Lucas) with the ones of k among those of j; the matrix is a five-fold Kronecker product, hence five steps.
ABN_HD constexpr std::uint32_t pascal_bits(std::uint32_t i) {
  i ^= (i >> 1) & 0x55555555U;
  i ^= (i >> 2) & 0x33333333U;
  i ^= (i >> 4) & 0x0F0F0F0FU;
  i ^= (i >> 8) & 0x00FF00FFU;
  return i ^ (i >> 16);
}

/// Owen scrambling of a coordinate whose bits are reversed: every bit flips by a hash of the bits that are worth more.
/// Source: Laine and Karras 2011 in the form of Vegdahl 2021, "Building a better LK hash".
ABN_HD constexpr std::uint32_t owen_hash(std::uint32_t v, std::uint32_t seed) {
  v ^= v * 0x3D20ADEAU;
  v += seed;
  v *= (seed >> 16) | 1U;
  v ^= v * 0x05526C56U;
  v ^= v * 0x53A22864U;
  return v;
}

}  // namespace abn
