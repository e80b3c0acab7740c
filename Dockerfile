# The service in a small image: built with the toolchain, run by a user who owns nothing but /data.
FROM rust:1.95-slim-bookworm AS build
WORKDIR /source
COPY . .
RUN cargo build --release --locked --bin meshwright

FROM debian:bookworm-slim
RUN useradd --system --no-create-home meshwright && install --directory --owner=meshwright /data
COPY --from=build /source/target/release/meshwright /usr/local/bin/meshwright
USER meshwright
VOLUME /data
# Inside a container the loopback would reach nobody; outside, publish the port where it should be seen.
ENV MESHWRIGHT_LISTEN=0.0.0.0:8080 MESHWRIGHT_DATABASE=/data/meshwright.db
EXPOSE 8080
HEALTHCHECK --interval=30s --timeout=5s --start-period=5s CMD ["meshwright", "health"]
ENTRYPOINT ["meshwright"]
CMD ["serve"]
