"""A client made of the proto files alone: every service of a running server, end to end.

    python client.py ADDRESS WORKSPACE [--ca FILE]     token in $D3DGEN_TOKEN

`WORKSPACE` is the checkout, for the files of domains/school and a few models. Exits with 1 at the first thing that is not
as the contract says.
"""

import argparse
import io
import os
import sys
import uuid
import zipfile
from pathlib import Path

import grpc
from google.rpc import error_details_pb2
from grpc_status import rpc_status

from d3dgen.v1 import asset_service_pb2 as assets_pb
from d3dgen.v1 import asset_service_pb2_grpc, domain_service_pb2_grpc, job_service_pb2_grpc
from d3dgen.v1 import domain_service_pb2 as domains_pb
from d3dgen.v1 import job_service_pb2 as jobs_pb
from d3dgen.v1 import knowledge_service_pb2 as knowledge_pb
from d3dgen.v1 import knowledge_service_pb2_grpc, world_service_pb2_grpc
from d3dgen.v1 import world_service_pb2 as worlds_pb

PIECE_BYTES = 64 * 1024
DEADLINE_S = 120


def check(holds, message):
    if not holds:
        sys.exit(f"not as the contract says: {message}")


def pages(call, request, field):
    """Yields the entries of all pages of a list."""
    while True:
        answer = call(request, timeout=DEADLINE_S)
        yield from getattr(answer, field)
        if not answer.next_page_token:
            return
        request.page_token = answer.next_page_token


class Client:
    def __init__(self, address, ca, token):
        if ca:
            credentials = grpc.ssl_channel_credentials(Path(ca).read_bytes())
            if token:
                credentials = grpc.composite_channel_credentials(credentials, grpc.access_token_call_credentials(token))
            channel = grpc.secure_channel(address, credentials)
        else:
            channel = grpc.insecure_channel(address)
        self.domains = domain_service_pb2_grpc.DomainServiceStub(channel)
        self.knowledge = knowledge_service_pb2_grpc.KnowledgeServiceStub(channel)
        self.assets = asset_service_pb2_grpc.AssetServiceStub(channel)
        self.worlds = world_service_pb2_grpc.WorldServiceStub(channel)
        self.jobs = job_service_pb2_grpc.JobServiceStub(channel)


def list_domains(client):
    found = list(pages(client.domains.ListDomains, domains_pb.ListDomainsRequest(page_size=2), "domains"))
    ids = [d.domain_id for d in found]
    check({"residential", "office", "hospital"} <= set(ids), f"shipped domains are listed, not {ids}")
    check(len(ids) == len(set(ids)), f"no domain is on two pages: {ids}")
    return ids


def read_school(client, workspace, domain_id):
    """Returns the school domain and its rules under another id, from the files of its folder."""
    folder = workspace / "domains" / "school"
    files = [
        domains_pb.DomainFile(name=path.name, content=path.read_bytes())
        for path in sorted(folder.iterdir())
        if path.suffix == ".toml" or path.name == "knowledge.json"
    ]
    parsed = client.domains.ParseDomain(domains_pb.ParseDomainRequest(files=files), timeout=DEADLINE_S)
    check(not parsed.problems, f"the files of school have no problems: {parsed.problems}")
    parsed.manifest.domain_id = domain_id
    parsed.manifest.title = "School of a client"
    parsed.knowledge_base.metadata.domain_id = domain_id
    return parsed.manifest, parsed.knowledge_base


def register(client, manifest, knowledge_base):
    request = domains_pb.RegisterDomainRequest(
        manifest=manifest, knowledge_base=knowledge_base, request_id=str(uuid.uuid4())
    )
    first = client.domains.RegisterDomain(request, timeout=DEADLINE_S).domain
    again = client.domains.RegisterDomain(request, timeout=DEADLINE_S).domain
    check(first == again, "a repeated request has the answer of the first")
    check(not first.shipped and first.registered_at.seconds > 0, "the domain says when it was registered")
    got = client.domains.GetDomain(
        domains_pb.GetDomainRequest(domain_id=first.domain_id, include_manifest=True), timeout=DEADLINE_S
    )
    check(got.manifest == manifest, "the manifest comes back as it was sent")
    return first


def search_rules(client, domain_id):
    request = knowledge_pb.SearchConstraintsRequest(query="clear width of corridors", page_size=5)
    request.filters["jurisdiction"].values.extend(["DE", "US"])
    found = client.knowledge.SearchConstraints(request, timeout=DEADLINE_S).constraints
    check(found, "rules about corridors are found")
    check({f.jurisdiction for f in found} <= {"DE", "US"}, "filters hold")
    check(all(f.sources and f.constraint.unit for f in found), "every rule has a source and a unit")
    applying = client.knowledge.RetrieveConstraints(
        knowledge_pb.RetrieveConstraintsRequest(
            domain_id=domain_id, country_code="DE", room_labels=["classroom", "classroom", "corridor"]
        ),
        timeout=DEADLINE_S,
    )
    check(applying.domain_id == domain_id and applying.constraints, "the rules of a school in Germany")
    return len(found), len(applying.constraints)


def wait_for(client, job_id):
    """Watches a job to its end and returns it."""
    fraction, job = 0.0, None
    for event in client.jobs.WatchJob(jobs_pb.WatchJobRequest(job_id=job_id, include_logs=True), timeout=DEADLINE_S):
        job = event.job
        check(job.progress.fraction >= fraction, "progress does not fall")
        fraction = job.progress.fraction
    check(job is not None and job.state == jobs_pb.JOB_STATE_SUCCEEDED, f"the job ends well: {job}")
    return job


def ingest(client, workspace):
    """Uploads a folder of models and waits until they are assets."""
    folder = workspace / "service" / "assets" / "tests" / "models"

    def parts():
        header = assets_pb.IngestHeader(folder_name="models", why="a test of clients", request_id=str(uuid.uuid4()))
        yield assets_pb.IngestAssetsRequest(header=header)
        for path in sorted(p for p in folder.rglob("*") if p.is_file()):
            content = path.read_bytes()
            for at in range(0, max(len(content), 1), PIECE_BYTES):
                chunk = assets_pb.FileChunk(
                    path=path.relative_to(folder).as_posix(), content=content[at : at + PIECE_BYTES]
                )
                yield assets_pb.IngestAssetsRequest(chunk=chunk)

    job = client.assets.IngestAssets(parts(), timeout=DEADLINE_S).job
    result = wait_for(client, job.job_id).ingest
    kept = result.added_count + result.updated_count + result.unchanged_count
    check(kept >= 3, f"models become assets: {result}")
    ids = {f.asset_id for f in result.files if f.HasField("asset_id")}
    one = client.assets.GetAsset(assets_pb.GetAssetRequest(asset_id=sorted(ids)[0]), timeout=DEADLINE_S).asset
    check(one.origin.WhichOneof("kind") == "ingested" and one.size_m.z_m > 0, f"an asset has origin and size: {one}")
    return kept


def search_assets(client):
    request = assets_pb.SearchAssetsRequest(query="bed for a patient", page_size=5)
    request.filter.height_m.max = 2.0
    found = client.assets.SearchAssets(request, timeout=DEADLINE_S).assets
    check(found, "there are beds")
    check(all(f.asset.size_m.z_m <= 2.0 for f in found), "limits of filters hold")
    return found[0].asset.asset_id


def generate(client, request):
    """Returns the sound world of a request and the names of the events on the way."""
    fraction, seen, checked = 0.0, [], None
    for event in client.worlds.GenerateWorld(request, timeout=DEADLINE_S):
        check(0.0 <= event.progress.fraction <= 1.0, "fractions are from 0 to 1")
        check(event.progress.fraction >= fraction, "progress does not fall")
        fraction = event.progress.fraction
        kind = event.WhichOneof("event")
        if kind:
            seen.append(kind)
        if kind == "world":
            checked = event.world
    check(checked is not None and checked.report.sound, f"the stream ends with a sound world: {seen}")
    wanted = ["scene_graph", "floorplan", "placements", "scenario", "world"]
    order = [seen.index(k) for k in wanted if k in seen]
    check(set(wanted[1:]) <= set(seen) and order == sorted(order), f"each stage is told in its order: {seen}")
    return checked.world, seen


def pin_and_regenerate(client, world):
    """Keeps the plan and the furniture of one room, and has the rest furnished anew."""
    room_id = next(p.room_id for p in world.placements.placements if p.mount == 1)
    pinned = worlds_pb.GenerateWorldRequest(scene_graph=world.scene_graph, name="pinned")
    pinned.scene_graph.seed += 1
    pinned.pinned_floorplan.CopyFrom(world.floorplan)
    for room in pinned.pinned_floorplan.rooms:
        room.locked = True
    pinned.pinned_placements.CopyFrom(world.placements)
    for placement in pinned.pinned_placements.placements:
        placement.locked = placement.room_id == room_id
    again, _ = generate(client, pinned)

    def standing(w):
        return {p.placement_id: (p.pose, p.asset_id) for p in w.placements.placements if p.room_id == room_id}

    before, after = standing(world), standing(again)
    check(before.items() <= after.items(), f"what is pinned in {room_id} stays where it was")
    check([r.polygon for r in again.floorplan.rooms] == [r.polygon for r in world.floorplan.rooms], "the plan stays")
    check(again.placements != world.placements, "the other rooms are furnished anew")
    return room_id


def export(client, world):
    archive = io.BytesIO()
    for piece in client.worlds.ExportWorld(worlds_pb.ExportWorldRequest(world=world), timeout=DEADLINE_S):
        archive.write(piece.chunk)
    with zipfile.ZipFile(archive) as opened:
        check(opened.testzip() is None, "the archive is whole")
        names = opened.namelist()
    check(any(n.endswith("world.yaml") for n in names), f"the archive has a world.yaml: {names[:10]}")
    return len(names), len(archive.getvalue())


def field_violations(error):
    """Returns path and description of each problem of an INVALID_ARGUMENT."""
    found = []
    status = rpc_status.from_call(error)
    for detail in status.details if status else []:
        bad = error_details_pb2.BadRequest()
        if detail.Unpack(bad):
            found += [(v.field, v.description) for v in bad.field_violations]
    return found


def broken_domain(client, manifest):
    """Sends a manifest with a mistake and reads from the answer where it is."""
    request = domains_pb.RegisterDomainRequest(manifest=manifest, validate_only=True)
    request.manifest.room_types[2].area_m2.min_m2 = 500
    request.manifest.room_types[2].area_m2.max_m2 = 5
    try:
        client.domains.RegisterDomain(request, timeout=DEADLINE_S)
    except grpc.RpcError as error:
        check(error.code() == grpc.StatusCode.INVALID_ARGUMENT, f"the code is {error.code()}: {error.details()}")
        found = field_violations(error)
        place = next((f for f, _ in found if f.startswith("manifest.room_types[2].area_m2")), None)
        check(place, f"the answer names the place: {found}")
        return place
    sys.exit("not as the contract says: a broken domain is registered")


def without_token(arguments):
    try:
        list_domains(Client(arguments.address, arguments.ca, None))
    except grpc.RpcError as error:
        check(error.code() == grpc.StatusCode.UNAUTHENTICATED, f"without a token the code is {error.code()}")
        return
    sys.exit("not as the contract says: a call without a token is answered")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("address")
    parser.add_argument("workspace", type=Path)
    parser.add_argument("--ca")
    arguments = parser.parse_args()
    token = os.environ.get("D3DGEN_TOKEN")
    client = Client(arguments.address, arguments.ca, token)
    if token:
        without_token(arguments)
    domain_id = "client_school_py"
    print("domains:", ", ".join(list_domains(client)))
    manifest, knowledge_base = read_school(client, arguments.workspace, domain_id)
    print("broken domain refused at", broken_domain(client, manifest))
    print("registered:", register(client, manifest, knowledge_base).title)
    check(domain_id in list_domains(client), "the registered domain is listed")
    print("rules found, applying:", *search_rules(client, domain_id))
    print("models ingested:", ingest(client, arguments.workspace))
    print("asset found:", search_assets(client))
    building = worlds_pb.BuildingRequest(prompt="primary school with three classrooms", seed=7, domain_id=domain_id)
    world, events = generate(client, worlds_pb.GenerateWorldRequest(building=building))
    check(world.scene_graph.domain_id == domain_id, "the world is of the registered domain")
    print(f"world {world.name}: {len(world.placements.placements)} objects, events {', '.join(events)}")
    print("pinned:", pin_and_regenerate(client, world))
    print("exported files, bytes:", *export(client, world))
    client.domains.RemoveDomain(domains_pb.RemoveDomainRequest(domain_id=domain_id), timeout=DEADLINE_S)
    check(domain_id not in list_domains(client), "the removed domain is gone")
    print("done")


if __name__ == "__main__":
    main()
