// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the mass-spring kernels, shared by C++ and OpenCL. All members have four bytes, so
// that both sides have the same layout.
#ifndef DeformVolumeMassSpringParameters_h
#define DeformVolumeMassSpringParameters_h

typedef struct
{
  float TimeStep;
  float Retained;   // the factor by which damping reduces the velocity in a step
  float Impulse;    // velocity that an acceleration of 1 adds in a step, which damping reduces too
  float Gravity[3]; // m/s^2
  float Limit;      // larger displacements mean that the simulation diverged
  int NumberOfNodes;
} MassSpringStep;

typedef struct
{
  int Node;
  float Begin[3]; // displacements
  float End[3];
} MassSpringHandle;

#endif
