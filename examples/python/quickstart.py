"""A world in a few lines: start `d3dgen serve`, then `python quickstart.py 127.0.0.1:50051`. See examples/README.md."""

import sys

import grpc

from d3dgen.v1 import world_service_pb2 as pb
from d3dgen.v1 import world_service_pb2_grpc

channel = grpc.insecure_channel(sys.argv[1])
worlds = world_service_pb2_grpc.WorldServiceStub(channel)

building = pb.BuildingRequest(prompt="hospital ward with 5 rooms in Germany, for a delivery robot", seed=1)
for event in worlds.GenerateWorld(pb.GenerateWorldRequest(building=building), timeout=60):
    print(f"{event.progress.fraction:4.0%} {event.progress.stage} {event.progress.message}")
    if event.WhichOneof("event") == "floorplan":  # the plan is there while furniture is still being placed
        for room in event.floorplan.rooms:
            print(f"     {room.name}: {room.net_area_m2:.1f} m2")
    if event.WhichOneof("event") == "world":
        checked = event.world

print("sound:", checked.report.sound, "with", len(checked.world.placements.placements), "objects")
for result in checked.report.constraints[:3]:
    print(f"  {result.name} of {result.subject}: {result.citation.source.title}")

with open("world.zip", "wb") as archive:
    for piece in worlds.ExportWorld(pb.ExportWorldRequest(world=checked.world), timeout=60):
        archive.write(piece.chunk)
print("wrote world.zip")
