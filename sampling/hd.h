// ABN_HD marks a function that runs on the host and, when compiled by nvcc, on the device too.
#pragma once

#ifdef __CUDACC__
#define ABN_HD __host__ __device__
#else
#define ABN_HD
#endif
