# The service in a small image: built with the toolchain, run by a user who owns nothing but /data. Other bases can be given, as
# tests/container/run does where no registry of images is reached.
ARG BUILD_IMAGE=rust:1.95-slim-bookworm
ARG RUN_IMAGE=debian:bookworm-slim

FROM ${BUILD_IMAGE} AS build
WORKDIR /source
# Names of functions stay for backtraces; lines of sources would be most of the image.
ENV CARGO_PROFILE_RELEASE_STRIP=debuginfo
# First the dependencies, in a layer that stays as long as the manifests do: the sources are empty, so that nothing else is built.
COPY Cargo.toml Cargo.lock ./
COPY crates/connections/Cargo.toml crates/connections/
COPY crates/engine/Cargo.toml crates/engine/
COPY crates/engine/benches/Cargo.toml crates/engine/benches/
COPY crates/exchange/Cargo.toml crates/exchange/build.rs crates/exchange/
COPY crates/fuzz-check/Cargo.toml crates/fuzz-check/
COPY crates/paper/Cargo.toml crates/paper/build.rs crates/paper/
COPY crates/plot/Cargo.toml crates/plot/
COPY crates/state/Cargo.toml crates/state/
COPY crates/store/Cargo.toml crates/store/
COPY crates/studies/Cargo.toml crates/studies/
COPY crates/wire/Cargo.toml crates/wire/
RUN mkdir -p build src benches/load && touch src/lib.rs crates/engine/benches/lib.rs \
    && for name in connections engine exchange fuzz-check paper plot state store studies wire; do mkdir -p crates/$name/src && touch crates/$name/src/lib.rs; done \
    && for file in build/main src/main benches/load/main crates/engine/benches/jobs crates/engine/benches/parts crates/paper/src/main; do \
         echo 'fn main() {}' > "$file.rs"; done \
    && cargo build --release --locked --features otlp --bin meshwright
COPY . .
# The empty sources were newer than these.
RUN touch build/main.rs src/lib.rs src/main.rs crates/*/src/lib.rs && cargo build --release --locked --features otlp --bin meshwright

FROM ${RUN_IMAGE}
# The certificates are for webhooks and for a PostgreSQL elsewhere.
RUN apt-get update && apt-get install --yes --no-install-recommends ca-certificates && rm -rf /var/lib/apt/lists/*
RUN useradd --system --no-create-home meshwright && install --directory --owner=meshwright /data
COPY --from=build /source/target/release/meshwright /usr/local/bin/meshwright
USER meshwright
VOLUME /data
# Inside a container the loopback would reach nobody. The service asks for keys there: docker exec ... meshwright keys create NAME
ENV MESHWRIGHT_LISTEN=0.0.0.0:8080 MESHWRIGHT_DATABASE=/data/meshwright.db
EXPOSE 8080
HEALTHCHECK --interval=30s --timeout=5s --start-period=5s CMD ["meshwright", "health"]
ENTRYPOINT ["meshwright"]
CMD ["serve"]
