// SPDX-License-Identifier: BSD-3-Clause
// Moves the nodes by the forces of their tetrahedra. Each node adds up its forces in a fixed order, so that sums do
// not depend on work-groups. The host defines LANES before this text, see MassSpringForces.cl.

// The sum of the forces of the tetrahedra of a node. begins: for each node, the first index in forceIndices.
// forceIndices: the index of the first component of each force.
static float3 GatherForce(
  __global const uint* begins, __global const uint* forceIndices, __global const float* forces, size_t node)
{
  float3 force = (float3)(0.0f);
  const uint end = begins[node + 1];
  for (uint i = begins[node]; i < end; ++i)
  {
    __global const float* source = forces + forceIndices[i];
    force += (float3)(source[0], source[LANES], source[2 * LANES]);
  }
  return force;
}

__kernel void AddForces(__global const uint* begins, __global const uint* forceIndices, __global const float* forces,
  __global float* sums, uint numberOfNodes)
{
  const size_t node = get_global_id(0);
  if (node < numberOfNodes)
  {
    vstore3(GatherForce(begins, forceIndices, forces, node), node, sums);
  }
}

// A step of the Verlet (leapfrog) method. mobilities: 1 / mass; 0 for nodes that do not move. loads: external forces.
// hasDiverged: set if a displacement is not finite or exceeds the limit.
__kernel void MoveNodes(__global const uint* begins, __global const uint* forceIndices, __global const float* forces,
  __global const float* mobilities, __global const float* loads, __global float* velocities,
  __global float* displacements, __global int* hasDiverged, MassSpringStep step, int hasLoads)
{
  const size_t node = get_global_id(0);
  if (node >= (size_t)step.NumberOfNodes)
  {
    return;
  }
  const float mobility = mobilities[node];
  if (mobility == 0.0f)
  {
    return;
  }
  float3 force = GatherForce(begins, forceIndices, forces, node);
  if (hasLoads)
  {
    force += vload3(node, loads);
  }
  const float3 gravity = (float3)(step.Gravity[0], step.Gravity[1], step.Gravity[2]);
  const float3 acceleration = force * mobility + gravity;
  const float3 velocity = vload3(node, velocities) * step.Retained + acceleration * step.Impulse;
  const float3 displacement = vload3(node, displacements) + velocity * step.TimeStep;
  vstore3(velocity, node, velocities);
  vstore3(displacement, node, displacements);
  const float3 size = fabs(displacement);
  if (!(size.x <= step.Limit && size.y <= step.Limit && size.z <= step.Limit))
  {
    *hasDiverged = 1;
  }
}

// Moves the nodes of handles on straight lines. fraction: the completed fraction of the way. rate: 1 / duration.
__kernel void MoveHandles(__global const MassSpringHandle* handles, __global float* velocities,
  __global float* displacements, float fraction, float rate, uint numberOfHandles)
{
  const size_t i = get_global_id(0);
  if (i >= numberOfHandles)
  {
    return;
  }
  const MassSpringHandle handle = handles[i];
  const float3 begin = (float3)(handle.Begin[0], handle.Begin[1], handle.Begin[2]);
  const float3 end = (float3)(handle.End[0], handle.End[1], handle.End[2]);
  const float3 way = end - begin;
  vstore3(way * rate, handle.Node, velocities);
  vstore3(fraction < 1.0f ? begin + way * fraction : end, handle.Node, displacements);
}

// Writes the displacements times a factor.
__kernel void WriteOutput(
  __global const float* displacements, __global float* output, float factor, uint numberOfValues)
{
  const size_t i = get_global_id(0);
  if (i < numberOfValues)
  {
    output[i] = displacements[i] * factor;
  }
}
