# The program in a small image: `docker build -t candela .`, then `docker run --rm -v "$PWD:/data" candela render helmet.glb`.
FROM debian:13-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates git
COPY . /candela
RUN cd /candela && ./dev package

FROM debian:13-slim
COPY --from=build /candela/out/candela_*.deb /tmp/
RUN apt-get update && apt-get install -y --no-install-recommends /tmp/candela_*.deb libgl1-mesa-dri && rm -rf /tmp/*.deb /var/lib/apt/lists/*
WORKDIR /data
ENTRYPOINT ["candela"]
