// A Kubernetes API server and the etcd that it takes, in one program: what is asked of it is answered as in a cluster, but nothing
// runs. Usage: api_server FOLDER PORT_OF_ETCD ARGUMENT_OF_KUBE_APISERVER...
package main

import (
	"log"
	"net/url"
	"os"
	"path/filepath"

	"go.etcd.io/etcd/server/v3/embed"
	"k8s.io/component-base/cli"
	"k8s.io/kubernetes/cmd/kube-apiserver/app"
)

func main() {
	if len(os.Args) < 3 {
		log.Fatal("usage: api_server FOLDER PORT_OF_ETCD ARGUMENT_OF_KUBE_APISERVER...")
	}
	clients := url.URL{Scheme: "http", Host: "127.0.0.1:" + os.Args[2]}
	config := embed.NewConfig()
	config.Dir = filepath.Join(os.Args[1], "etcd")
	config.LogLevel = "error"
	config.UnsafeNoFsync = true // nothing of it is kept
	config.ListenClientUrls = []url.URL{clients}
	config.AdvertiseClientUrls = config.ListenClientUrls
	config.ListenPeerUrls = nil
	store, err := embed.StartEtcd(config)
	if err != nil {
		log.Fatal(err)
	}
	defer store.Close()
	<-store.Server.ReadyNotify()
	os.Args = append([]string{"kube-apiserver", "--etcd-servers", clients.String()}, os.Args[3:]...)
	os.Exit(cli.Run(app.NewAPIServerCommand()))
}
